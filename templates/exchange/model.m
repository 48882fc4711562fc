% {{source}} rebuilt for Octave or MATLAB, written by bodesmith.
% Blocks in series, first to last: x' = A x + b u, y = c x + d u, then delayed. Offsets are left out.
1;  % a script, not a function file
A = {}; b = {}; c = {}; d = []; delay_s = [];
{{#blocks}}
% {{name}}
A{end + 1} = reshape([{{a}}], {{order}}, {{order}}).';
b{end + 1} = reshape([{{b}}], {{order}}, 1);
c{end + 1} = reshape([{{c}}], 1, {{order}});
d(end + 1) = {{d}};
delay_s(end + 1) = {{delay_s}};
{{/blocks}}

% H at frequencies in Hz, block by block.
H = @(f) exp(-2i * pi * f * sum(delay_s));
for i = 1:numel(d)
  Ai = A{i}; bi = b{i}; ci = c{i}; di = d(i);
  before = H;
  if isempty(bi)
    H = @(f) before(f) * di;
  else
    H = @(f) before(f) .* arrayfun(@(s) ci * ((s * eye(numel(bi)) - Ai) \ bi) + di, 2i * pi * f);
  end
end

% With the control package or toolbox: the chain as one system, without its delay.
if exist("OCTAVE_VERSION", "builtin")
  try
    pkg load control
  catch
  end
end
if exist("ss", "file") || exist("ss", "builtin")
  sys = ss(1);
  for i = 1:numel(d)
    sys = sys * ss(A{i}, b{i}, c{i}, d(i));
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
  error("the rebuilt model is not that of bodesmith");
end
