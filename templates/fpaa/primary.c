/* Complete primary configurations of the FPAAs, made from {{plan}} without any vendor program.
 * STATUS: {{status}}.
 * Read first_power_on.md before the first load.
 * An AN231 takes a primary after power-up or reset only. On SPI (mode 0, most significant bit first): five
 * bytes 00 before and one after. Chips in the order of their Address1. */
{{#arrays}}

/* Chip {{chip}}, Address1 = {{chip}}:{{#pins}} {{pin}} = {{cell}}{{/pins}} */
const unsigned char {{name}}[{{count}}] =
{
{{#rows}}
   {{.}}
{{/rows}}
};
const unsigned int {{name}}_length = {{count}};
{{/arrays}}
