% {{source}} rebuilt for Octave or MATLAB, written by bodesmith.
% CAMs of an FPAA, each sampled at its own clock, without holds and delays: sum over inputs of
% (n0 + n1/z + ...)/(d0 + d1/z + ...) times what feeds it, z = exp(2 pi j f/clock).
1;  % a script, not a function file
names = {""};  % signal 1 is the input of the board; each CAM stands behind those that feed it
cam = {};
{{#blocks}}
names{end + 1} = "{{name}}";
cam{end + 1} = struct("clock_hz", {{clock_hz}}, "from", [{{#inputs}}{{place}} {{/inputs}}] + 1, "denominator", [{{denominator}}]);
cam{end}.numerators = { {{#inputs}}[{{numerator}}], {{/inputs}} };
{{/blocks}}
output = {{place}} + 1;

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

% H at frequencies in Hz (a column), CAM by CAM.
in_z = @(p, z) sum(bsxfun(@times, p(:).', bsxfun(@power, z(:), -(0:numel(p) - 1))), 2);
signal = ones(numel(check_hz), 1);
for i = 1:numel(cam)
  z = exp(2i * pi * check_hz / cam{i}.clock_hz);
  made = zeros(numel(check_hz), 1);
  for k = 1:numel(cam{i}.from)
    made = made + in_z(cam{i}.numerators{k}, z) .* signal(:, cam{i}.from(k));
  end
  signal(:, end + 1) = made ./ in_z(cam{i}.denominator, z);
end
got = signal(:, output);

% With the control package or toolbox: each CAM's way from each input as a system sampled at its clock.
if exist("OCTAVE_VERSION", "builtin")
  try
    pkg load control
  catch
  end
end
if exist("tf", "file") || exist("tf", "builtin")
  for i = 1:numel(cam)
    for k = 1:numel(cam{i}.from)
      n = cam{i}.numerators{k};
      m = cam{i}.denominator;
      size_ = max(numel(n), numel(m));
      cam{i}.systems{k} = tf([n, zeros(1, size_ - numel(n))], [m, zeros(1, size_ - numel(m))], 1 / cam{i}.clock_hz);
    end
  end
end

off = max(abs(got ./ check_response - 1));
fprintf("off by at most %.1e at %d frequencies\n", off, numel(check_hz));
if off > 1e-9
  error("the rebuilt plan is not that of bodesmith");
end
