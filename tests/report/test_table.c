/* SPDX-License-Identifier: GPL-3.0-or-later */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "mt_test.h"
#include "report/design.h"
#include "report/summary.h"
#include "report/table.h"

static void number__shows_significant_digits(mt_test *t)
{
    static const struct {
        double x;
        int digits;
        const char *want;
    } rows[] = {
        {18.0, 6, "18.0000"},    {0.610329821, 6, "0.610330"},
        {17678.0, 6, "17678.0"}, {100000.0, 6, "100000"},
        {2.1e11, 6, "2.1e+11"},  {-1.5e-9, 3, "-1.5e-09"},
        {0.0, 6, "0"},           {-0.0, 6, "0"},
    };
    char s[MT_NUMBER_TEXT];
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_test_row(t, "%s", rows[i].want);
        CHECK_STR(t, mt_report_number(rows[i].x, rows[i].digits, s), rows[i].want);
    }
    CHECK_STR(t, mt_report_number(nan(""), 6, s), "-");
    CHECK_STR(t, mt_report_change(3.2, 3, s), "+3.20");
    CHECK_STR(t, mt_report_change(nan(""), 3, s), "-");
    CHECK_STR(t, mt_report_exact(0.1, s), "0.10000000000000001");
    CHECK_STR(t, mt_report_exact(nan(""), s), "");
    CHECK_STR(t, mt_report_number(HUGE_VAL, 6, s), "infinite");
    CHECK_STR(t, mt_report_change(-HUGE_VAL, 3, s), "-infinite");
    CHECK_STR(t, mt_report_exact(HUGE_VAL, s), "");
}

/* name, value */
static mt_table two_columns(void)
{
    mt_table table = mt_table_default();
    mt_table_column(&table, "name", "name", MT_ALIGN_LEFT);
    mt_table_column(&table, "f [Hz]", "frequency_hz", MT_ALIGN_POINT);
    return table;
}

static void table__aligns_decimal_points_and_counts_characters_not_bytes(mt_test *t)
{
    mt_table table = two_columns();
    mt_text out = {.s = NULL};
    mt_table_text(&table, "größe");
    mt_table_number(&table, 1234.5, 5);
    mt_table_text(&table, "b");
    mt_table_number(&table, 1.0, 3);
    mt_table_text(&table, NULL);
    mt_table_number(&table, nan(""), 3);
    mt_table_print(&table, 1, 0, &out);
    CHECK_STR(t, out.s,
              " name    f [Hz]\n"
              " -----  -------\n"
              " größe  1234.5\n"
              " b         1.00\n"
              " -         -\n");
    CHECK_INT(t, mt_table_rows(&table), 3);
    mt_text_free(&out);
    mt_table_free(&table);
}

static void table__keeps_rows_in_lines_and_counts_columns_of_the_terminal(mt_test *t)
{
    mt_table table = two_columns();
    mt_text out = {.s = NULL};
    mt_table_text(&table, "a\nb\033[2J");
    mt_table_number(&table, 1.0, 2);
    mt_table_text(&table, "\xE6\xA2\x81"); /* an ideograph: two columns */
    mt_table_number(&table, 2.0, 2);
    mt_table_text(&table, "e\xCC\x81"); /* e and an accent: one */
    mt_table_number(&table, 3.0, 2);
    mt_table_print(&table, 0, 0, &out);
    CHECK_STR(t, out.s,
              "name               f [Hz]\n"
              "-----------------  ------\n"
              "a\\u000ab\\u001b[2J     1.0\n"
              "\xE6\xA2\x81                    2.0\n"
              "e\xCC\x81                     3.0\n");
    mt_text_free(&out);
    mt_table_free(&table);
}

static void table__puts_numbers_below_the_end_of_a_wide_heading(mt_test *t)
{
    mt_table table = mt_table_default();
    mt_text out = {.s = NULL};
    mt_table_column(&table, "frequency [Hz]", "f", MT_ALIGN_POINT);
    mt_table_column(&table, "n", "n", MT_ALIGN_RIGHT);
    mt_table_number(&table, 1.5, 2);
    mt_table_integer(&table, 12);
    mt_table_print(&table, 0, 0, &out);
    CHECK_STR(t, out.s,
              "frequency [Hz]   n\n"
              "--------------  --\n"
              "           1.5  12\n");
    mt_text_free(&out);
    mt_table_free(&table);
}

static void csv__quotes_what_rfc_4180_asks_for(mt_test *t)
{
    static const struct {
        const char *field;
        const char *want;
    } rows[] = {
        {"plain", "plain"},    {"a,b", "\"a,b\""}, {"say \"no\"", "\"say \"\"no\"\"\""},
        {"a\nb", "a\\u000ab"}, /* a row is a line */
        {"a\rb", "a\\u000db"}, {"", ""},           {"größe", "größe"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_text out = {.s = NULL};
        mt_test_row(t, "%s", rows[i].field);
        mt_csv_field(rows[i].field, &out);
        CHECK_STR(t, out.s == NULL ? "" : out.s, rows[i].want);
        mt_text_free(&out);
    }
}

/* What a spreadsheet would take for a formula has an apostrophe in front; taking it away gives
 * the text back. */
static void csv__protects_formulas_and_leaves_numbers(mt_test *t)
{
    static const struct {
        const char *field;
        const char *want;
    } rows[] = {
        {"=1+1", "'=1+1"},
        {"@SUM(A1)", "'@SUM(A1)"},
        {"+cmd|x!A", "'+cmd|x!A"},
        {"-2+3", "'-2+3"},
        {"  =1", "'  =1"},
        {"'=1", "''=1"},
        {"-", "'-"},
        {"-e5", "'-e5"},
        {"-1.5.2", "'-1.5.2"},
        {"-1e", "'-1e"},
        {"=a,b", "\"'=a,b\""},
        {"\xEF\xBC\x9D"
         "1",
         "'\xEF\xBC\x9D"
         "1"},
        {"-1.5", "-1.5"},
        {"+3", "+3"},
        {"-.5e-3", "-.5e-3"},
        {"-1.E+10", "-1.E+10"},
        {"-3.2999999999999998e-14", "-3.2999999999999998e-14"},
        {"a=b", "a=b"},
        {"it's", "it's"},
        {"'quoted'", "'quoted'"},
    };
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_text out = {.s = NULL};
        mt_test_row(t, "%s", rows[i].field);
        mt_csv_field(rows[i].field, &out);
        CHECK_STR(t, out.s, rows[i].want);
        mt_text_free(&out);
    }
}

static void csv__has_members_exact_numbers_and_crlf(mt_test *t)
{
    mt_table table = two_columns();
    mt_text out = {.s = NULL};
    mt_table_text(&table, "a,b");
    mt_table_number(&table, 0.1, 3);
    mt_table_text(&table, NULL);
    mt_table_percent(&table, -3.3e-14, 3);
    mt_table_csv(&table, &out);
    CHECK_STR(t, out.s,
              "name,frequency_hz\r\n"
              "\"a,b\",0.10000000000000001\r\n"
              ",-3.2999999999999998e-14\r\n");
    mt_text_free(&out);
    mt_table_free(&table);
}

static void html__escapes_every_special_character(mt_test *t)
{
    mt_text out = {.s = NULL};
    mt_html_escape("<b a=\"1\">&'\x01\xC3\xA9</b>", &out);
    CHECK_STR(t, out.s, "&lt;b a=&quot;1&quot;&gt;&amp;&#39;\\u0001\xC3\xA9&lt;/b&gt;");
    mt_text_free(&out);
    mt_table table = two_columns();
    mt_table_text(&table, "<script>");
    mt_table_number(&table, 2.0, 2);
    mt_table_html(&table, &out);
    CHECK_STR(t, out.s,
              "<table>\n<thead><tr><th>name</th><th class=\"n\">f [Hz]</th></tr></thead>\n"
              "<tbody>\n<tr><td>&lt;script&gt;</td><td class=\"n\">2.0</td></tr>\n"
              "</tbody>\n</table>\n");
    mt_text_free(&out);
    mt_table_free(&table);
}

/* A column that holds nothing is left out, the first one never. */
static void print__leaves_out_what_is_empty(mt_test *t)
{
    mt_text out = {.s = NULL};
    mt_table table = mt_table_default();
    mt_table_column(&table, "name", "name", MT_ALIGN_LEFT);
    mt_table_column(&table, "unit", "unit", MT_ALIGN_LEFT);
    mt_table_column(&table, "value", "value", MT_ALIGN_POINT);
    for (int i = 0; i < 2; i++) {
        mt_table_text(&table, NULL);
        mt_table_text(&table, NULL);
        mt_table_number(&table, i == 0 ? 1.5 : nan(""), 2);
    }
    mt_table_print(&table, 0, 0, &out);
    CHECK_STR(t, out.s, "name  value\n----  -----\n-       1.5\n-       -\n");
    mt_text_free(&out);
    mt_table_csv(&table, &out);
    CHECK_STR(t, out.s, "name,unit,value\r\n,,1.5\r\n,,\r\n");
    mt_text_free(&out);
    mt_table_free(&table);
}

/* What does not fit follows below, behind the same first columns; nothing is lost, and no line
 * is longer than it has to be. */
static void print__folds_to_the_width(mt_test *t)
{
    enum { COLUMNS = 9, ROWS = 3 };
    mt_table table = mt_table_default();
    char text[16];
    mt_table_column(&table, "where", "where", MT_ALIGN_LEFT);
    mt_table_column(&table, "mode", "mode", MT_ALIGN_RIGHT);
    for (int c = 0; c < COLUMNS; c++) {
        (void)snprintf(text, sizeof text, "head%d", c);
        mt_table_column(&table, text, text, MT_ALIGN_POINT);
    }
    for (int i = 0; i < ROWS; i++) {
        mt_table_text(&table, "installed");
        mt_table_integer(&table, i + 1);
        for (int c = 0; c < COLUMNS; c++) {
            mt_table_number(&table, 1000.0 + (100.0 * i) + c, 4);
        }
    }
    for (int width = 1; width < 100; width++) {
        mt_text out = {.s = NULL};
        mt_table_print(&table, 2, width, &out);
        mt_test_row(t, "width %d", width);
        REQUIRE(t, out.s != NULL && !out.failed);
        for (int i = 0; i < ROWS; i++) {
            for (int c = 0; c < COLUMNS; c++) {
                (void)snprintf(text, sizeof text, "%d", 1000 + (100 * i) + c);
                const char *const at = strstr(out.s, text);
                CHECK(t, at != NULL && strstr(at + 1, text) == NULL);
            }
        }
        for (const char *line = out.s; *line != '\0';) {
            const int length = (int)strcspn(line, "\n");
            /* keys and one column may need more */
            CHECK(t, length <= (width > 24 ? width : 24));
            CHECK(t, length == 0 || strncmp(line, "  inst", 6) == 0 ||
                         strncmp(line, "  wher", 6) == 0 || strncmp(line, "  ----", 6) == 0);
            line += length + 1;
        }
        mt_text_free(&out);
    }
    mt_table_free(&table);
}

/* The cell in the last row of a table, for people; for machines. */
static void check_cell(mt_test *t, const mt_table *table, const char *people,
                       const char *machines)
{
    mt_text out = {.s = NULL};
    char want[2 * MT_NUMBER_TEXT];
    mt_table_print(table, 0, 0, &out);
    const char *const at = strstr(out.s, "\na");
    const char *const cell = at == NULL ? out.s : at + 2 + strspn(at + 2, " ");
    (void)snprintf(want, sizeof want, "%s\n", people);
    CHECK_STR(t, cell, want);
    mt_text_free(&out);
    mt_table_csv(table, &out);
    (void)snprintf(want, sizeof want, "name,frequency_hz\r\na,%s\r\n", machines);
    CHECK_STR(t, out.s, want);
    mt_text_free(&out);
}

/* People are shown the margin that a clearance keeps, up to what searches leave open, a
 * relative 1e-6 of the frequency: 1e-4 percent of 100 + margin percent. Likewise 0 of a goal
 * that is met, and of what is noise. Machines have what was computed. */
static void numbers__that_searches_leave_open_are_what_was_asked(mt_test *t)
{
    static const struct {
        double percent;
        double margin;
        const char *people;
    } rows[] = {{12.5, 10.0, "12.5000000"},       {9.9, 10.0, "9.90000000"},
                {10.0, 10.0, "10.0000000"},       {9.9998925, 10.0, "10.0000000"},
                {9.9998875, 10.0, "9.99988750"},  {10.0001075, 10.0, "10.0000000"},
                {10.0001125, 10.0, "10.0001125"}, {49.9998525, 50.0, "50.0000000"},
                {49.9998475, 50.0, "49.9998475"}, {-0.9e-4, 0.0, "0"},
                {-1.1e-4, 0.0, "-0.000110000000"}};
    for (int i = 0; i < MT_COUNT(rows); i++) {
        mt_table table = two_columns();
        char machines[MT_NUMBER_TEXT];
        mt_test_row(t, "%.10g beside %g", rows[i].percent, rows[i].margin);
        mt_table_text(&table, "a");
        mt_table_clearance(&table, rows[i].percent, rows[i].margin, 9);
        check_cell(t, &table, rows[i].people, mt_report_exact(rows[i].percent, machines));
        mt_table_free(&table);
    }
    static const struct {
        double percent;
        bool met;
        const char *people;
    } off[] = {{0.9e-4, true, "0"},       {-0.9e-4, true, "0"}, {1.1e-4, true, "+0.000110"},
               {0.9e-4, false, "+9e-05"}, {0.9e-7, false, "0"}, {-1.1e-7, false, "-1.1e-07"},
               {-2.5, false, "-2.50"}};
    for (int i = 0; i < MT_COUNT(off); i++) {
        mt_table table = two_columns();
        char machines[MT_NUMBER_TEXT];
        mt_test_row(t, "off by %g", off[i].percent);
        mt_table_text(&table, "a");
        mt_table_off_by(&table, off[i].percent, off[i].met, 3);
        check_cell(t, &table, off[i].people, mt_report_exact(off[i].percent, machines));
        mt_table_free(&table);
    }
}

/* A struct with a member of each kind that a cell can hold, in JSON's order. */
typedef struct sample {
    double hz;
    const char *kind;
    int index;
    bool repeated;
    double change;
    long steps;
} sample;

#define THIS sample
static const mt_field sample_fields[] = {
    MT_F_NUMBER_OR_NULL("frequency_hz", hz, ""), MT_F_TEXT_OR_NULL("kind", kind, ""),
    MT_F_COUNT_OR_NULL("index", index, 1, ""),   MT_F_FLAG("repeated", repeated, ""),
    MT_F_NUMBER_OR_NULL(NULL, change, ""),       MT_F_LONG("steps", steps, "")};
static const mt_record sample_record = MT_F_RECORD_OF(sample_fields, NULL, NULL);
static const mt_record_column sample_columns[] = {
    MT_R_COLUMN(index, "mode", 0, MT_IN_TABLES),
    MT_R_COLUMN(kind, "its kind", 0, MT_IN_TEXT),
    MT_R_COLUMN(hz, "frequency [Hz]", 4, MT_IN_TABLES),
    MT_R_COLUMN(repeated, "repeated", 0, MT_IN_CSV),
    MT_R_CHANGE(change, "change [%]", "change_percent", 3, MT_IN_CSV | MT_IN_OWN),
    MT_R_COLUMN(steps, "steps", 0, MT_IN_CSV)};
static const mt_record_table sample_table = MT_R_TABLE_OF(sample_record, sample_columns);
#undef THIS

static void record__has_columns_where_they_are_asked_for(mt_test *t)
{
    static const sample rows[] = {{.hz = 2.5,
                                   .kind = "flexible",
                                   .index = 1,
                                   .repeated = true,
                                   .change = 4.0,
                                   .steps = 7},
                                  {.hz = -10.25, .change = -1.0, .steps = 12}};
    static const struct {
        unsigned in;
        const char *text;
        const char *csv;
    } places[] = {
        {MT_IN_TEXT,
         "mode  its kind  frequency [Hz]\n----  --------  --------------\n"
         "   1  flexible           2.500\n   -  -                -10.25\n",
         "index,kind,frequency_hz\r\n1,flexible,2.5\r\n,,-10.25\r\n"},
        {MT_IN_TEXT | MT_IN_OWN,
         "mode  its kind  frequency [Hz]  change [%]\n----  --------  -------------- "
         " ----------\n"
         "   1  flexible           2.500       +4.00\n   -  -                -10.25        "
         "-1.00\n",
         "index,kind,frequency_hz,change_percent\r\n1,flexible,2.5,4\r\n,,-10.25,-1\r\n"},
        {MT_IN_CSV, NULL,
         "index,frequency_hz,repeated,change_percent,steps\r\n1,2.5,true,4,7\r\n"
         ",-10.25,false,-1,12\r\n"}};
    for (int k = 0; k < MT_COUNT(places); k++) {
        mt_table table = mt_table_default();
        mt_text out = {.s = NULL};
        mt_test_row(t, "places %u", places[k].in);
        mt_table_record_columns(&table, &sample_table, places[k].in);
        for (int i = 0; i < MT_COUNT(rows); i++) {
            mt_table_record_row(&table, &sample_table, places[k].in, &rows[i]);
        }
        mt_table_csv(&table, &out);
        CHECK_STR(t, out.s, places[k].csv);
        mt_text_free(&out);
        mt_table_print(&table, 0, 0, &out);
        CHECK_STR(t, out.s, places[k].text == NULL ? out.s : places[k].text);
        mt_text_free(&out);
        mt_table_free(&table);
    }
}

MT_TEST_MAIN(MT_TEST(number__shows_significant_digits),
             MT_TEST(print__leaves_out_what_is_empty), MT_TEST(print__folds_to_the_width),
             MT_TEST(table__aligns_decimal_points_and_counts_characters_not_bytes),
             MT_TEST(table__keeps_rows_in_lines_and_counts_columns_of_the_terminal),
             MT_TEST(table__puts_numbers_below_the_end_of_a_wide_heading),
             MT_TEST(csv__quotes_what_rfc_4180_asks_for),
             MT_TEST(csv__protects_formulas_and_leaves_numbers),
             MT_TEST(csv__has_members_exact_numbers_and_crlf),
             MT_TEST(numbers__that_searches_leave_open_are_what_was_asked),
             MT_TEST(record__has_columns_where_they_are_asked_for),
             MT_TEST(html__escapes_every_special_character))
