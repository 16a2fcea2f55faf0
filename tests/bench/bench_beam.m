% SPDX-License-Identifier: GPL-3.0-or-later
% The beam the paper's way, in GNU Octave: 27 coordinates (x, y, angle of nine rigid elements), 16 constraints, accelerations by
%     xdd = a + M^-1/2 (A M^-1/2)^+ (b - A a)                                                   (Eq. 1)
% with pinv, the 54 x 54 Jacobian of the state by central differences, its eigenvalues by eig, springs by fsolve with a numerical
% Jacobian. Prints "name value" lines: CPU times in seconds, and the numbers themselves for whoever judges them.
1;

function xd = state_rate(x, K, p)
  n = 9;
  q = reshape(x(1:27), 3, n);
  v = reshape(x(28:54), 3, n);
  th = q(3, :); w = v(3, :);
  bend = K(:)' .* diff(th);
  Q = zeros(3, n);
  Q(3, 1:n-1) += bend;
  Q(3, 2:n) -= bend;
  a = Q(:) ./ p.mass;
  A = zeros(16, 27); b = zeros(16, 1);
  h = p.le / 2;
  for i = 1:n-1
    r = 2*i - 1; c = 3*(i-1);
    % x_{i+1} - x_i - h cos(th_i) - h cos(th_{i+1}) = 0, the same with y and sin, differentiated twice
    A(r, c+[1 4]) = [-1 1];   A(r, c+[3 6]) = h * [sin(th(i)) sin(th(i+1))];
    b(r) = -h * (cos(th(i))*w(i)^2 + cos(th(i+1))*w(i+1)^2);
    A(r+1, c+[2 5]) = [-1 1]; A(r+1, c+[3 6]) = -h * [cos(th(i)) cos(th(i+1))];
    b(r+1) = -h * (sin(th(i))*w(i)^2 + sin(th(i+1))*w(i+1)^2);
  end
  s = 1 ./ sqrt(p.mass);
  xd = [x(28:54); a + s .* (pinv(A .* s') * (b - A*a))];
end

function hz = frequencies(K, p)
  J = zeros(54);
  for j = 1:54
    e = zeros(54, 1);
    e(j) = p.step;
    J(:, j) = (state_rate(p.x0 + e, K, p) - state_rate(p.x0 - e, K, p)) / (2*p.step);
  end
  omega = sort(imag(eig(J)));
  omega = omega(omega > 1);        % rigid-body motions and constraint drift: about 0
  hz = omega(1:4) / (2*pi);
end

function g = gradient(K, p)
  g = zeros(4, 8);
  for i = 1:8
    d = zeros(1, 8);
    d(i) = 1e-4 * K(i);
    g(:, i) = (frequencies(K + d, p) - frequencies(K - d, p)) / (2*d(i));
  end
end

p.le = 2*sqrt(2) / 9;
me = 1/9;
p.mass = repmat([me; me; me*p.le^2/12], 9, 1);
p.step = 1e-6;
centres = ((1:9) - 0.5) * p.le;
p.x0 = [reshape([centres; zeros(2, 9)], 27, 1); zeros(27, 1)];
height = 1 / (2710*0.05*2*sqrt(2));
K0 = 70e9*0.05*height^3/12 / p.le * ones(1, 8);

frequencies(K0, p);                % warm up
% CPU seconds; as on the other side, the median of several rounds and their spread
function print_time(name, t)
  printf("%s_s %.17g\n%s_spread_s %.17g\n", name, median(t), name, max(t) - min(t));
end
t = zeros(1, 9);
for k = 1:9
  c = cputime; f = frequencies(K0, p); t(k) = cputime - c;
end
print_time("evaluation", t);
printf("hz %.17g\n", f);
t = zeros(1, 3);
for k = 1:3
  c = cputime; g = gradient(K0, p); t(k) = cputime - c;
end
print_time("gradient", t);
printf("slope %.17g\n", g');

target = [1.704; 4.697; 9.208; 15.22];
global calls = 0;
function r = misses(k, target, p)
  global calls;
  calls += 1;
  r = frequencies([k fliplr(k)], p) - target;
end
for n = 1:3
  calls = 0;
  c = cputime; [k, r, info] = fsolve(@(k) misses(k, target, p), K0(1:4)); t(n) = cputime - c;
end
print_time("identification", t);
printf("calls %d\n", calls);
printf("info %d\n", info);
printf("spring %.17g\n", k);
