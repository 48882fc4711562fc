/* {{source}} as digital biquads, written by bodesmith.
 *
 * H(z) = {{upper}}_GAIN * prod_i (b0 + b1/z + b2/z^2)/(1 + a1/z + a2/z^2) at {{sample_hz}} Hz, by {{method}}, {{at}}.
 * Against the analog sections it is off by at most {{error}}{{steep}}.
 * {{delay}}
 *
 *   {{name}}_state s = { 0 };
 *   y = {{name}}_step(&s, x);
 */
#define {{upper}}_SAMPLE_HZ {{sample_hz}}
#define {{upper}}_BIQUADS {{count}}
#define {{upper}}_GAIN {{gain}}

typedef struct {
  {{type}} w[{{upper}}_BIQUADS][2];
} {{name}}_state;

/* b0, b1, b2, a1, a2 */
static const {{type}} {{name}}_coefficients[{{upper}}_BIQUADS][5] = {
{{#biquads}}
    { {{b0}}, {{b1}}, {{b2}}, {{a1}}, {{a2}} },
{{/biquads}}
};

/* One sample in, one out: direct form II transposed. */
static {{type}} {{name}}_step({{name}}_state *s, {{type}} x) {
  int i;
  x *= {{upper}}_GAIN;
  for (i = 0; i < {{upper}}_BIQUADS; ++i) {
    const {{type}} *c = {{name}}_coefficients[i];
    const {{type}} y = c[0] * x + s->w[i][0];
    s->w[i][0] = c[1] * x - c[3] * y + s->w[i][1];
    s->w[i][1] = c[2] * x - c[4] * y;
    x = y;
  }
  return x;
}
