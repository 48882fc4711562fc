#!/usr/bin/env python3
"""Places the plan's CAMs on a Zrna board (one AN231) and prints what it realised. Needs the zrna client.

Frequencies are in kHz, as the client takes them. Not tried on hardware. The board chooses capacitors itself: compare
"realised" with "plan".
"""
import sys

import zrna.api

z = zrna.api.Client()
z.connect(sys.argv[1] if len(sys.argv) > 1 else None)
z.clear()
z.set_divisor(z.CLOCK_SYS1, {{sys1}})
{{#clocks}}
z.set_divisor(z.CLOCK{{clock}}, {{divisor}})
{{/clocks}}

plan = []


def place(name, module, clock, values):
    module.set_clock(clock)
    for key, value in values.items():
        setattr(module, key, value)
    z.add(module)
    plan.append((name, module, values))


{{#cams}}
place("{{name}}", z.{{class}}({{arguments}}), z.CLOCK{{clock}}, {
{{#attributes}}
    "{{name}}": {{value}},
{{/attributes}}
})
{{/cams}}

audio_in, audio_out = z.AudioIn(), z.AudioOut()
z.add(audio_in)
z.add(audio_out)
previous = audio_in
for _, module, _ in plan:
    previous.output.connect(module.input)
    previous = module
previous.output.connect(audio_out.input)
z.run()

for name, module, values in plan:
    for key, value in values.items():
        print(f"{name} {key}: plan {value:.6g}, realised {getattr(module, key).realized:.6g}")
