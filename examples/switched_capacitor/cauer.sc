* Fifth-order elliptic low pass, pass band to 1 rad/s, as a leapfrog of five op-amps: the values and the wiring of
* Modelica.Electrical.Analog.Examples.CauerLowPassSC. A resistor of 1 ohm is a capacitor of T/1 ohm that is switched
* to the virtual ground and back to ground (inverting), one of -1 ohm takes up its voltage half a period before.
.clock main 10
V1 in 0
.output o5

O1 0 n1 o1
O2 0 n2 o2
O3 0 n3 o3
O4 0 n4 o4
O5 0 n5 o5
C1 n1 o1 1.33580178
C2 o3 n1 0.263801777
C3 n2 o2 1.304
C4 o5 n3 0.836537833
C5 o1 n3 0.263801777
C6 n3 o3 2.78233961
C7 n4 o4 0.8586
C8 o3 n5 0.836537833
C9 n5 o5 1.56273783
* r1 = 1 ohm
S1 in ur1 main.1
S2 ur1 0 main.2
S3 wr1 n1 main.1
S4 wr1 0 main.2
Cr1 ur1 wr1 0.1
* r2 = 1 ohm
S5 o2 ur2 main.1
S6 ur2 0 main.2
S7 wr2 n1 main.1
S8 wr2 0 main.2
Cr2 ur2 wr2 0.1
* r3 = 1 ohm
S9 o1 ur3 main.1
S10 ur3 0 main.2
S11 wr3 n1 main.1
S12 wr3 0 main.2
Cr3 ur3 wr3 0.1
* r4 = -1 ohm
S13 o1 ur4 main.2
S14 ur4 0 main.1
S15 wr4 0 main.2
S16 wr4 n2 main.1
Cr4 ur4 wr4 0.1
* r5 = -1 ohm
S17 o3 ur5 main.2
S18 ur5 0 main.1
S19 wr5 0 main.2
S20 wr5 n2 main.1
Cr5 ur5 wr5 0.1
* r6 = 1 ohm
S21 o4 ur6 main.1
S22 ur6 0 main.2
S23 wr6 n3 main.1
S24 wr6 0 main.2
Cr6 ur6 wr6 0.1
* r7 = 1 ohm
S25 o2 ur7 main.1
S26 ur7 0 main.2
S27 wr7 n3 main.1
S28 wr7 0 main.2
Cr7 ur7 wr7 0.1
* r8 = -1 ohm
S29 o5 ur8 main.2
S30 ur8 0 main.1
S31 wr8 0 main.2
S32 wr8 n4 main.1
Cr8 ur8 wr8 0.1
* r9 = -1 ohm
S33 o3 ur9 main.2
S34 ur9 0 main.1
S35 wr9 0 main.2
S36 wr9 n4 main.1
Cr9 ur9 wr9 0.1
* r10 = 1 ohm
S37 o4 ur10 main.1
S38 ur10 0 main.2
S39 wr10 n5 main.1
S40 wr10 0 main.2
Cr10 ur10 wr10 0.1
* r11 = 1 ohm
S41 o5 ur11 main.1
S42 ur11 0 main.2
S43 wr11 n5 main.1
S44 wr11 0 main.2
Cr11 ur11 wr11 0.1
