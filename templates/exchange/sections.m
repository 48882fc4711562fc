% {{source}} rebuilt for Octave or MATLAB, written by bodesmith.
% H(s) = gain * prod_i k(i) * prod(s - zero)/prod(s - pole) * exp(-s delay_s), zeros and poles in rad/s.
1;  % a script, not a function file
gain = {{gain}};
delay_s = {{delay_s}};
z = {};
p = {};
k = [];
{{#sections}}
z{end + 1} = [{{zeros}}];
p{end + 1} = [{{poles}}];
k(end + 1) = {{gain}};
{{/sections}}

% H at frequencies in Hz, from the factors themselves.
H = @(f) exp(-2i * pi * f * delay_s) * gain;
for i = 1:numel(k)
  zi = z{i};
  pi_ = p{i};
  ki = k(i);
  before = H;
  H = @(f) before(f) .* ki .* arrayfun(@(s) prod(s - zi) / prod(s - pi_), 2i * pi * f);
end

% With the control package or toolbox: the chain as one system, without its delay.
if exist("OCTAVE_VERSION", "builtin")
  try
    pkg load control
  catch
  end
end
if exist("zpk", "file") || exist("zpk", "builtin")
  sys = zpk([], [], gain);
  for i = 1:numel(k)
    sys = sys * zpk(z{i}(:), p{i}(:), k(i));
  end
end

% Responses that bodesmith computed.
check_hz = [
{{#checks}}
  {{frequency_hz}}
{{/checks}}
];
check_response = [
{{#checks}}
  {{response}}
{{/checks}}
];
off = max(abs(H(check_hz) ./ check_response - 1));
fprintf("off by at most %.1e at %d frequencies\n", off, numel(check_hz));
if off > 1e-9
  error("the rebuilt sections are not those of bodesmith");
end
