#!/usr/bin/env python3
"""Writes the sample files beside it, after each format's documentation (README.md says which): all of them hold the
same low-pass of 1 kHz, H(f) = 1/(1 + jf/1000 Hz), or a record of it. Files of ngspice come from ngspice itself."""
import cmath, math, pathlib, struct, subprocess, tempfile, zlib

here = pathlib.Path(__file__).parent
corner = 1000.0
freqs = [10 * 10 ** (i / 4) for i in range(17)]


def h(f):
    return 1 / (1 + 1j * f / corner)


def db(x):
    return 20 * math.log10(abs(x))


def deg(x):
    return math.degrees(cmath.phase(x))


def write(name, text, encoding="utf-8", end="\n"):
    (here / name).write_bytes(text.replace("\n", end).encode(encoding))


def comma(x, digits=8):
    return f"{x:.{digits}g}".replace(".", ",")


# Digilent WaveForms, network analyser: as it exports today, and with kHz, tabs and a channel that is not relative.
head = """#Digilent WaveForms Network Analyzer - Bode
#Device Name: Discovery2
#Serial Number: SN:000000000000
#Date Time: 2024-05-01 10:00:00.000
#Start: 10 Hz
#Stop: 100000 Hz (100 kHz)
#Steps: 17
#Wavegen: Wavegen1
#Amplification: 1 X
#Channel: Channel 1
#Range: 5.5 V
#Offset: 0 V
#Relative: no
#Channel: Channel 2
#Range: 5.5 V
#Offset: 0 V
#Relative: {}
"""
rows = "".join(f"{f:.12g},-3.0103,{db(h(f)):.10g},{deg(h(f)):.10g}\n" for f in freqs)
write("waveforms_network.csv", head.format("yes") +
      "Frequency (Hz),Channel 1 Magnitude (dB),Channel 2 Magnitude (dB),Channel 2 Phase (*)\n" + rows, end="\r\n")
rows = "".join(f"{f / 1000:.12g}\t-6\t{db(h(f)) - 6:.10g}\t{deg(h(f)):.10g}\n" for f in freqs)
write("waveforms_network_khz.csv", head.format("no") +
      "Frequency (kHz)\tChannel 1 Magnitude (dB)\tChannel 2 Magnitude (dB)\tChannel 2 Phase (°)\n" + rows)

# Digilent WaveForms, scope: 100 Hz sine, its answer settled.
g = h(100)
times = [i * 1e-4 - 2e-3 for i in range(80)]
u = [math.sin(2 * math.pi * 100 * t) for t in times]
y = [abs(g) * math.sin(2 * math.pi * 100 * t + cmath.phase(g)) for t in times]
write("waveforms_scope.csv", "#Digilent WaveForms Oscilloscope Acquisition\n#Device Name: Discovery2\n"
      "#Sample rate: 10000Hz\n#Samples: 80\n\nTime (s),Channel 1 (V),Channel 2 (V)\n" +
      "".join(f"{t:.10g},{a:.10g},{b:.10g}\n" for t, a, b in zip(times, u, y)))
# PicoScope: a line of units, milliseconds and millivolts.
write("picoscope.csv", "Time,Channel A,Channel B\n(ms),(V),(mV)\n\n" +
      "".join(f"{t * 1e3:.10g},{a:.10g},{b * 1e3:.10g}\n" for t, a, b in zip(times, u, y)))

# Bode 100: semicolons, decimal commas, Latin-1; with and without the block of settings.
heading = ('Frequency (Hz);"Trace 1: Gain: Real ";"Trace 1: Gain: Imaginary ";Trace 1: Gain: Magnitude (dB);'
           '"Trace 2: Gain: Real ";"Trace 2: Gain: Imaginary ";Trace 2: Gain: Phase (°)\n')
rows = "".join(";".join(comma(v, 11) for v in (f, h(f).real, h(f).imag, db(h(f)), h(f).real, h(f).imag, deg(h(f)))) + "\n"
               for f in freqs)
write("bode100.csv", heading + rows, "latin-1", "\r\n")
write("bode100_settings.csv", "---Measurement settings---\nDate;01.05.2024 10:00\nStart frequency;10\n"
      "Stop frequency;100000\nNumber of points;17\n\n---Measurement results---\n" + heading + rows)

# REW and its relatives.
rew = "* Measurement data measured by REW V5.20.4\n* Source: no instrument, a formula\n* Note: ; first order\n*\n"
write("rew.txt", rew + "* Freq(Hz) SPL(dB) Phase(degrees)\n" +
      "".join(f"{f:.6f} {db(h(f)) + 80:.3f} {deg(h(f)):.4f}\n" for f in freqs))
write("speaker.frd", "".join(f"{f:.6f}\t{db(h(f)):.4f}\t{deg(h(f)):.4f}\n" for f in freqs))
write("impedance.zma", "* Freq(Hz) Z(Ohms) Phase(degrees)\n" +
      "".join(f"{f:.6f} {8 * abs(h(f)):.6f} {deg(h(f)):.4f}\n" for f in freqs))

# Touchstone. H is S21; S11 is 0.5 H, S12 0.25, S22 0.1j.
def pairs(kind, values):
    out = []
    for v in values:
        if kind == "RI":
            out.append(f"{v.real:.10g} {v.imag:.10g}")
        elif kind == "MA":
            out.append(f"{abs(v):.10g} {deg(v):.10g}")
        else:
            out.append(f"{db(v):.10g} {deg(v):.10g}")
    return " ".join(out)


def two_port(kind, order):
    return "".join(f"{f / 1e6:.12g} " + pairs(kind, [{"11": h(f) / 2, "21": h(f), "12": 0.25, "22": 0.1j}[k]
                                                     for k in order]) + "\n" for f in freqs)


usual = ["11", "21", "12", "22"]
write("ma.s2p", "! a first-order low-pass\n# MHZ S MA R 50\n" + two_port("MA", usual) +
      "! noise: frequency, minimum figure, reflection, resistance\n0.001 1.5 0.3 20 0.4\n0.002 1.6 0.3 21 0.4\n")
write("ri.s2p", "# mhz S ri R 50 ! option words in any case and order\n" + two_port("RI", usual))
write("db.s1p", "# HZ S DB R 75\n" + "".join(f"{f:.12g} {pairs('DB', [h(f)])}\n" for f in freqs))
write("z.s1p", "# KHZ Z RI R 50\n" + "".join(f"{f / 1e3:.12g} {pairs('RI', [h(f) / 50])}\n" for f in freqs))
write("version2.s2p", "[Version] 2.0\n# MHZ S MA R 50\n[Number of Ports] 2\n[Two-Port Data Order] 12_21\n"
      "[Number of Frequencies] 17\n[Reference] 50 75\n[Begin Information]\n[Title] low-pass\n[End Information]\n"
      "[Network Data]\n" + two_port("MA", ["11", "12", "21", "22"]) + "[End]\n")

# A .s4p: the first line of a point has a frequency and four pairs, the others four pairs. S21 is H.
text = "# KHZ S RI R 50\n"
for f in freqs:
    matrix = [[h(f) if (i, j) == (1, 0) else (i + 1 + 0.1 * j) * 0.01 for j in range(4)] for i in range(4)]
    for i in range(4):
        text += (f"{f / 1e3:.12g} " if i == 0 else "   ") + pairs("RI", [complex(v) for v in matrix[i]]) + "\n"
write("four.s4p", text)

# LTspice: exported text both ways, steps; raw files as version XVII writes them (UTF-16 header).
write("ltspice_polar.txt", "Freq.\tV(out)\n" +
      "".join(f"{f:.15e}\t({db(h(f)):.15e}dB,{deg(h(f)):.15e}°)\n" for f in freqs), "latin-1", "\r\n")
write("ltspice_steps.txt", "Freq.\tV(in)\tV(out)\n" +
      "".join(f"Step Information: R={r}  (Step: {k + 1}/2)\n" +
              "".join(f"{f:.15e}\t1.0e+00,0.0e+00\t{(h(f) * s).real:.15e},{(h(f) * s).imag:.15e}\n" for f in freqs)
              for k, (r, s) in enumerate((("1K", 2), ("2K", 1)))), "latin-1", "\r\n")


def raw(name, plot, flags, names, points, body):
    header = (f"Title: * low-pass\nDate: Wed May 01 10:00:00 2024\nPlotname: {plot}\nFlags: {flags}\n"
              f"No. Variables: {len(names)}\nNo. Points: {points:12d}\nOffset:   0.0000000000000000e+000\n"
              "Command: Linear Technology Corporation LTspice XVII\nVariables:\n")
    for i, (n, t) in enumerate(names):
        header += f"\t{i}\t{n}\t{t}\n"
    (here / name).write_bytes((header + "Binary:\n").encode("utf-16-le") + body)


acnames = [("frequency", "frequency"), ("V(in)", "voltage"), ("V(out)", "voltage")]
body = b"".join(struct.pack("<6d", f, 0, 1, 0, h(f).real, h(f).imag) for f in freqs)
raw("ltspice_ac.raw", "AC Analysis", "complex forward log", acnames, 17, body)
# A step of 1 V at 0 with uneven times, one of them marked by its sign.
times = [0, 1e-5, 3e-5, 7e-5, 1.5e-4, 2.5e-4, 3.5e-4, 5e-4, 7e-4, 1e-3, 1.4e-3, 2e-3]
answer = [1 - math.exp(-2 * math.pi * corner * t) for t in times]
trnames = [("time", "time"), ("V(in)", "voltage"), ("V(out)", "voltage")]
body = b"".join(struct.pack("<dff", -t if i == 5 else t, 1, a) for i, (t, a) in enumerate(zip(times, answer)))
raw("ltspice_tran.raw", "Transient Analysis", "real forward", trnames, 12, body)
body = struct.pack("<12d", *times) + struct.pack("<12d", *[1] * 12) + struct.pack("<12d", *answer)
raw("ltspice_tran_fast.raw", "Transient Analysis", "real forward double fastaccess", trnames, 12, body)

# ngspice, by itself.
deck = """low-pass
V1 in 0 dc 0 ac 1 sin(0 1 100)
R1 in out 1k
C1 out 0 {c:.15g}
.control
{kind}
ac dec 4 10 100k
write {ac} v(in) v(out)
tran 20u 10m
write {tran} v(in) v(out)
.endc
.end
"""
with tempfile.TemporaryDirectory() as folder:
    for kind in ("binary", "ascii"):
        path = pathlib.Path(folder) / "deck.cir"
        path.write_text(deck.format(c=1 / (2 * math.pi * 1e3 * corner), kind="set filetype=" + kind,
                                    ac=f"ngspice_ac_{kind}.raw", tran=f"ngspice_tran_{kind}.raw"))
        subprocess.run(["ngspice", "-b", str(path)], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        (here / f"ngspice_ac_{kind}.raw").write_bytes((pathlib.Path(folder) / f"ngspice_ac_{kind}.raw").read_bytes())
    (here / "ngspice_tran_binary.raw").write_bytes((pathlib.Path(folder) / "ngspice_tran_binary.raw").read_bytes())

# WAV: 16 bits of two channels, and floating point of one.
def wave(name, code, bits, channels, rate, data):
    fmt = struct.pack("<HHIIHH", code, channels, rate, rate * channels * bits // 8, channels * bits // 8, bits)
    chunks = b"fmt " + struct.pack("<I", 16) + fmt + b"LIST" + struct.pack("<I", 5) + b"odd..\0" + \
        b"data" + struct.pack("<I", len(data)) + data
    (here / name).write_bytes(b"RIFF" + struct.pack("<I", 4 + len(chunks)) + b"WAVE" + chunks)


wave("stereo16.wav", 1, 16, 2, 10000, b"".join(struct.pack("<hh", round(a * 32767), round(b * 32767))
                                               for a, b in zip(u, y)))
wave("mono_float.wav", 3, 32, 1, 10000, b"".join(struct.pack("<f", a) for a in u))


# MATLAB level 5: uncompressed, f and a complex H (written out after the format's description).
def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)


def matrix(name, values):
    is_complex = isinstance(values[0], complex)
    inner = element(6, struct.pack("<II", 6 | (0x0800 if is_complex else 0), 0))
    inner += element(5, struct.pack("<ii", len(values), 1)) + element(1, name.encode())
    inner += element(9, struct.pack(f"<{len(values)}d", *[complex(v).real for v in values]))
    if is_complex:
        inner += element(9, struct.pack(f"<{len(values)}d", *[v.imag for v in values]))
    return element(14, inner)


def mat(name, *matrices):
    header = b"MATLAB 5.0 MAT-file, written by make_samples.py".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
    (here / name).write_bytes(header + b"".join(matrices))


mat("response.mat", matrix("f", freqs), matrix("H", [h(f) for f in freqs]))
mat("bode.mat", matrix("wout", [2 * math.pi * f for f in freqs]), matrix("mag", [abs(h(f)) for f in freqs]),
    matrix("phase", [deg(h(f)) for f in freqs]))
mat("record.mat", matrix("fs", [10000.0]), matrix("u", u), matrix("y", y))
mat("compressed.mat", *[struct.pack("<II", 15, len(z)) + z for z in
                        (zlib.compress(one) for one in (matrix("fs", [10000.0]), matrix("u", u), matrix("y", y)))])

# Bare tables.
write("plain.txt", "".join(f"{f:.10g} {abs(h(f)):.10g}\n" for f in freqs))
write("plain_comma.csv", "".join(f"{comma(f)};{comma(db(h(f)))};{comma(deg(h(f)))}\n" for f in freqs))
write("bare.zma", "".join(f"{f:.6f} {8 * abs(h(f)):.6f} {deg(h(f)):.4f}\n" for f in freqs))

# Layouts of instruments and programs, their headings as public listings show them.
def rows(*columns, between=","):
    return "".join(between.join(f"{v:.12g}" for v in row) + "\n" for row in zip(*columns))


levels, angles = [db(h(f)) for f in freqs], [deg(h(f)) for f in freqs]
re, im = [h(f).real for f in freqs], [h(f).imag for f in freqs]
ones = [1.0] * 17
write("hfss.csv", '"Freq [kHz]","dB(S(1,1)) []","dB(S(2,1)) []","cang_deg(S(2,1)) [deg]"\n' +
      rows([f / 1e3 for f in freqs], [-20.0] * 17, levels, angles))
write("keysight_fra.csv", "#, Frequency (Hz), Amplitude (Vpp), Gain (dB), Phase (°)\n" +
      rows(range(1, 18), freqs, [2.0] * 17, levels, angles))
write("fra4picoscope.csv", "Frequency Log(Hz), Gain (dB), Phase (deg)\n" +
      rows([math.log10(f) for f in freqs], levels, angles, between=", "))
write("moku.csv", "% Moku:Go Frequency Response Analyzer\n% Frequency (Hz), Channel A Magnitude (dB), Channel A Phase (deg), "
      "Channel B Magnitude (dB), Channel B Phase (deg), Math (Ch B / Ch A) Magnitude (dB), Math (Ch B / Ch A) Phase (deg)\n" +
      rows(freqs, [-6.0] * 17, [10.0] * 17, [v - 6 for v in levels], [v + 10 for v in angles], levels, angles))
write("bare_reference.s2p", "# KHz S RI R\n" + "".join(
    f"{f / 1e3:.12g} " + pairs("RI", [h(f) / 2, h(f), 0.25 + 0j, 0.1j]) + "\n" for f in freqs))
write("eis.txt", "freq Zre Zim |Vac|\n" + rows(freqs, re, im, [0.01] * 17, between=" "))
write("biologic.txt", "freq/Hz\tRe(Z)/Ohm\t-Im(Z)/Ohm\t|Z|/Ohm\n" +
      rows(freqs, re, [-v for v in im], [abs(h(f)) for f in freqs], between="\t"))
write("pna.csv", "!CSV A.01.01\n!Keysight Technologies,N5200A,none\n!Source: Standard\n\nBEGIN CH1_DATA\n"
      "Freq(Hz),S11(REAL),S11(IMAG),S21(REAL),S21(IMAG)\n" + rows(freqs, ones, ones, re, im) + "END\n", end="\r\n")
write("empty_cells.csv", "Frequency (Hz),Remark,Gain (dB),Phase (deg)\n" + "".join(
    f"{f:.12g},,{a:.10g},{b:.10g}\n" + ("15,,,\n" if i == 3 else "") for i, (f, a, b) in enumerate(zip(freqs, levels, angles))))
write("dbv_ohm.txt", "Frequency(Hz)\tdBv/Ohm\tPhase(deg)\n" + rows(freqs, levels, angles, between="\t"))
write("network.cti", "CITIFILE A.01.00\nNAME DATA\nVAR FREQ MAG 17\nDATA S[1,1] RI\nDATA S[2,1] DBANGLE\nVAR_LIST_BEGIN\n" +
      rows(freqs) + "VAR_LIST_END\nBEGIN\n" + rows([v / 2 for v in re], [v / 2 for v in im]) + "END\nBEGIN\n" +
      rows(levels, angles) + "END\n")
write("utf16.csv", "Frequency (Hz),Gain (dB),Phase (deg)\n" + rows(freqs, levels, angles), "utf-16")
mat("other_names.mat", matrix("ff", freqs), matrix("resp", [h(f) for f in freqs]), matrix("drive", u), matrix("answer", y),
    matrix("clock", [i * 1e-4 for i in range(80)]))

write("rigol.csv", "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-2.000000e-03,1.000000e-04\n" +
      "".join(f"{i},{a:.10g},{b:.10g},,\n" for i, (a, b) in enumerate(zip(u, y))))
preamble = ["Record Length,80", "Sample Interval,1e-04", "Trigger Point,20", ",", ",", ",", "Source,CH1", "Vertical Units,V",
            "Vertical Scale,0.5", "Vertical Offset,0", "Horizontal Units,s", "Horizontal Scale,1e-3", "Pt Fmt,Y"]
write("tektronix_tds.csv", "".join(
    f"{preamble[i] if i < len(preamble) else ','},,{1e-4 * i - 2e-3:018.12f},{a:10.6f},\n" for i, a in enumerate(u)))
instek = ("Memory Length,80\nTrigger Level,0\nSource,CH1\nVertical Units,V\nVertical Scale,2.000E-01\nHorizontal Units,S\n"
          "Sampling Period,1.000E-04\nWaveform Data,\n")
write("instek_detail.csv", instek + "".join(f"{1e-4 * i - 2e-3:.4e},{a:.9e},\n" for i, a in enumerate(u)))
write("instek_codes.csv", instek + "".join(f"{round(a / 0.2 * 25)},\n" for a in u))
write("keysight_scope.csv", "x-axis,1,2,4\nsecond,Volt,Volt,Volt\n" + rows([1e-4 * i - 2e-3 for i in range(80)], u, y, [0.0] * 80))
write("samples.csv", "u,y\n" + rows(u, y))


# A complex sparse u, as MATLAB writes it: row numbers, column starts, real and imaginary parts; and a full y.
sparse = element(6, struct.pack("<II", 5 | 0x0800, 2)) + element(5, struct.pack("<ii", 80, 1)) + element(1, b"u") + \
    element(5, struct.pack("<ii", 3, 7)) + element(5, struct.pack("<ii", 0, 2)) + \
    element(9, struct.pack("<2d", 1, 2)) + element(9, struct.pack("<2d", 3, 4))
mat("sparse.mat", matrix("fs", [10000.0]), element(14, sparse), matrix("y", y))
mat("complex_input.mat", matrix("fs", [10000.0]), matrix("u", [complex(v, 1) for v in u]), matrix("y", y))
