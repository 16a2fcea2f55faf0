# SPDX-License-Identifier: GPL-3.0-or-later
# The beginning of a page of each kind (src/report/page.h), up to its title: the same whatever it shows. Style and script are in it,
# and a policy that names them by their digests.
# cmake -D OUT=FOLDER -D D3=FILES... -P heads.cmake: FOLDER/page_head_<kind>.html
cmake_minimum_required(VERSION 3.25)

# What the script of a page is made of, in this order; the last one begins to draw.
set(report_scripts
    d3-array.js d3-color.js d3-format.js d3-interpolate.js d3-path.js d3-time.js d3-time-format.js d3-scale.js
    d3-scale-chromatic.js d3-shape.js d3-dsv.js d3-dispatch.js d3-timer.js d3-ease.js d3-selection.js d3-transition.js
    d3-drag.js d3-brush.js base.js text.js figure.js units.js grid.js designs.js alternatives.js chart_frequencies.js
    chart_parameters.js chart_rotor.js responses.js chart_bode.js chart_nyquist.js chart_psd.js chart_drive.js
    chart_trade.js chart_front.js chart_parallel.js chart_tolerance.js chart_maps.js chart_mac.js chart_published.js
    chart_search.js chart_history.js origin.js space.js camera.js pose.js symbols.js paint.js dom.js drawing.js
    view3d.js modes.js drive.js show.js report.js)
set(show_scripts
    base.js space.js camera.js pose.js symbols.js paint.js dom.js drawing.js view3d.js modes.js drive.js show.js)
set(plain_styles page.css)
set(report_styles page.css view.css report.css)
set(show_styles page.css view.css)
# What a report without a scene has no use for: all that shows one, but for what is shared.
set(view_scripts ${show_scripts})
list(REMOVE_ITEM view_scripts base.js)

foreach(file IN LISTS D3)
    cmake_path(GET file FILENAME name)
    string(REPLACE ".min.js" ".js" name ${name})
    set(path_${name} ${file})
endforeach()

# Ours are without indents, empty lines and lines of comment, which are a quarter of them (none has a text of several lines);
# others' keep their notice of copyright.
function(add_scripts variable)
    set(all "")
    foreach(name IN LISTS ARGN)
        if(DEFINED path_${name})
            file(READ ${path_${name}} text)
            string(APPEND all "${text}\n")
        else()
            file(READ ${CMAKE_CURRENT_LIST_DIR}/${name} text)
            string(REGEX REPLACE "\n[ \n]+" "\n" text "\n${text}")
            string(REGEX REPLACE "\n//[^\n]*" "" text "${text}")
            string(SUBSTRING "${text}" 1 -1 text)
            string(APPEND all "${text}")
        endif()
    endforeach()
    set(${variable} "${all}" PARENT_SCOPE)
endfunction()

# The digest as the policy wants it: base 64 (RFC 4648) of its 256 bits, which are 42 letters and four bits more.
function(digest variable text)
    set(letters ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/)
    string(SHA256 hexadecimal "${text}")
    set(code "")
    foreach(at RANGE 0 63 3)
        string(SUBSTRING "${hexadecimal}00" ${at} 3 part)
        math(EXPR first "0x${part} >> 6")
        math(EXPR second "0x${part} & 63")
        string(SUBSTRING ${letters} ${first} 1 first)
        string(SUBSTRING ${letters} ${second} 1 second)
        string(APPEND code ${first}${second})
    endforeach()
    string(SUBSTRING ${code} 0 43 code)
    set(${variable} "${code}=" PARENT_SCOPE)
endfunction()

function(write_head kind styles)
    add_scripts(script ${ARGN})
    set(style "")
    foreach(name IN LISTS styles)
        file(READ ${CMAKE_CURRENT_LIST_DIR}/${name} text)
        string(APPEND style "${text}")
    endforeach()
    digest(style_digest "${style}")
    set(policy "default-src 'none'; style-src 'sha256-${style_digest}'; img-src data: blob:; base-uri 'none'; form-action 'none'")
    set(element "")
    if(ARGN)
        digest(script_digest "${script}")
        string(APPEND policy "; script-src 'sha256-${script_digest}'")
        set(element "<script>${script}</script>\n")
    endif()
    set(head "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n")
    string(APPEND head "<meta http-equiv=\"Content-Security-Policy\" content=\"${policy}\">\n")
    string(APPEND head "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<link rel=\"icon\" href=\"data:,\">\n")
    file(WRITE ${OUT}/page_head_${kind}.html "${head}<style>${style}</style>\n${element}")
endfunction()

set(plain_reports ${report_scripts})
list(REMOVE_ITEM plain_reports ${view_scripts})
write_head(plain "${plain_styles}")
write_head(report "${report_styles}" ${plain_reports})
write_head(report_scene "${report_styles}" ${report_scripts})
write_head(show "${show_styles}" ${show_scripts})
