#pragma once
/// The signals of `--command` and `--excite` for the end of a help text.

namespace hydrapod::cli {

inline constexpr const char* signal_help =
    "\n\nSignals (keys and defaults; sizes x y z rx ry rz, or all; SI or with units):\n"
    "  rest\n"
    "  step z=5 mm, at=0.1 s, rise=0 s\n"
    "  sine x=10 mm, frequency=1 Hz\n"
    "  sweep ry=1 deg, from=0.5 Hz, to=20 Hz, duration=20 s, spacing=log\n"
    "  chirp z=1 mm, from=0.5 Hz, to=20 Hz, period=1 s\n"
    "  multisine z=2 mm, from=0.5 Hz, to=20 Hz, period=10 s, slope=0, crest=random, experiment=1\n"
    "  white all=0.1 mm\n"
    "  noise x=1 mm, from=0 Hz, to=20 Hz, slope=0\n"
    "  binary z=1 mm, to=20 Hz, period=10 s\n"
    "  file motion.csv\n"
    "fade=0.5 s: smooth start, of all but step and file. seed: of multisine, white, noise, "
    "binary.\n"
    "level=amplitude or rms, of sine, sweep and chirp; the sizes of the random signals are RMS.\n"
    "turns=N, of sweep and chirp: N passes per direction in turn; turns=0: all directions "
    "together.";

}  // namespace hydrapod::cli
