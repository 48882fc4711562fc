// {{source}} as fixed-point biquads, written by bodesmith.
//
// H(z) = prod_i (b0 + b1/z + b2/z^2)/(1 + a1/z + a2/z^2) at {{sample_hz}} Hz, by {{method}}; the chain's gain is in the first
// section's numerator. Coefficients are {{bits}} bits, two's complement, {{fraction}} of them behind the point.
// Against the analog sections it is off by at most {{error}} ({{unrounded}} before rounding), above -60 dB{{steep}}.
// Noise of the products' rounding is not in it: keep {{fraction}} bits more in the accumulator.
// {{budget}}
`define {{upper}}_BIQUADS {{count}}
`define {{upper}}_BITS {{bits}}
`define {{upper}}_FRACTION {{fraction}}
{{#biquads}}
localparam signed [{{top}}:0] {{name}}_b0_{{number}} = {{b0}};
localparam signed [{{top}}:0] {{name}}_b1_{{number}} = {{b1}};
localparam signed [{{top}}:0] {{name}}_b2_{{number}} = {{b2}};
localparam signed [{{top}}:0] {{name}}_a1_{{number}} = {{a1}};
localparam signed [{{top}}:0] {{name}}_a2_{{number}} = {{a2}};
{{/biquads}}
