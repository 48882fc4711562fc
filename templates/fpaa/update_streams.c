/* Update streams for the FPAAs, made from {{plan}} and the project's own ApiCode.c.
 * Send each after the project's primary configuration. They set capacitors and clock divisors only. */
{{#arrays}}

const unsigned char {{name}}[{{count}}] =
{
{{#rows}}
   {{.}}
{{/rows}}
};
const unsigned int {{name}}_length = {{count}};
{{/arrays}}
