#include "ApiCode.h"
const an_Byte an_apiAddress1[an_apiChipCount] =
{
   0x01  /* an_FPAA1 */
};
const an_Byte an_FPAA1_PrimaryConfigInfo[] = 
{
   0x00, 0xD5, 0xB7, 0x20, 0x01, 0x00, 0x01, 0xC1,
   0x80, 0x00, 0x01, 0x20, 0x2A, 0x00
};
/* Component data table for the apiCapacitor's of Gain1. */
extern const an_apiCapacitor an_FPAA1_Gain1_Capacitor[2] = 
{
   /* Cin   */ { 0x03, 0x07, }, /* 3, 7 */
   /* Cout  */ { 0x03, 0x06, }, /* 3, 6 */
};
