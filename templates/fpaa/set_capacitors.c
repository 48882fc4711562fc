/* Sets the capacitors of {{plan}} through the generated API. Compile it with the project's ApiCode.c and CAMCode.c
 * and give it a function that sends the bytes to the chip. Each CAM is an update of its own: the generated buffer
 * holds 64 bytes. Clock divisors stay as the primary configuration set them. */
#include "ApiCode.h"

typedef void (*send_update)(int chip, const unsigned char* bytes, int count);
{{#chips}}

static void set_chip{{chip}}(send_update send)
{
   int count = 0;
   const unsigned char* bytes;
   {{p}}_InitializeApexReconfigData({{id}});
{{#cams}}

{{#calls}}
   {{p}}_SetCapValue({{cam}}, {{index}}, {{units}}); /* {{capacitor}} */
{{/calls}}
   bytes = {{p}}_GetApexReconfigData({{id}}, &count);
   send({{chip}}, bytes, count);
   {{p}}_ClearApexReconfigData({{id}});
{{/cams}}

   {{p}}_ShutdownApexReconfigData({{id}});
}
{{/chips}}

void set_capacitors(send_update send)
{
{{#chips}}
   set_chip{{chip}}(send);
{{/chips}}
}
