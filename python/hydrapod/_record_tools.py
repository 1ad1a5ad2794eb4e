"""Records as files: a look, another format, a part, another sample rate, a picture, checksums, recovery."""

from __future__ import annotations

from typing import Any, List, NamedTuple, Optional, Union

from . import _checks, _core
from ._checks import Texts
from ._core import RecordOverview
from ._machine import Quantity
from ._records import Path, Record, files_of
from ._tasks import Progress, _only


class WrittenRecord(NamedTuple):
    """A record that was written."""

    path: str  #: the file
    samples: int
    warnings: List[str]  #: of reading and of writing


class RecoveredRecord(NamedTuple):
    """What was left of a damaged record."""

    path: str  #: the new file
    samples: int  #: in it
    warnings: List[str]
    declared: Optional[int]  #: samples that the damaged record says it had; None: it says nothing
    unfinished: bool  #: whether its writer was ended before it was complete
    has_checksum: bool  #: whether it states a checksum; of a part that says nothing
    checksum: str  #: holds, differs or none, of the whole record
    uneven: bool  #: whether channels are absent or end before others


class VerifiedRecord(NamedTuple):
    """Whether a record holds what was written."""

    path: str
    samples: int
    channels: int
    checksum: str  #: holds, differs or none: another program wrote the file, its format has none, it is not complete
    warnings: List[str]


def show_record(record: Union[Path, Record], *, rate: Optional[Quantity] = None, spectra: bool = False,
                progress: Optional[Progress] = None) -> RecordOverview:
    """Channels of a record with levels, clipping, drop-outs and spectra.

    record: a file or a Record. rate: sample rate [Hz] of files that do not tell it. spectra: put them into
    .to_dict() too, as `hydrapod record show --spectra` does.

    Result, c channels, L lines: channels, units, roles, directions; mean, rms, lowest, highest, peak (c,) [of the
    channel]; at_limit, longest_hold, missing, infinite (c,) [samples]; strongest_frequency_hz (c,) [Hz];
    spectrum_frequency_hz (L,) [Hz], spectra (L, c) [unit²/Hz]; samples, sample_rate [Hz], start, duration [s].
    Raises InputError for a file that is no record, ComputationError where progress stops. Source: docs/howto/record.md.
    C++: tasks::show_record in hydrapod/tasks/measurement.hpp.
    """
    with files_of(record) as files:
        return _core.show_record(_checks.options(file=_only(files, "record"), rate=rate, spectra=spectra), progress)


def convert_record(record: Union[Path, Record], path: Path, *, format: Optional[str] = None,
                   rate: Optional[Quantity] = None, progress: Optional[Progress] = None) -> WrittenRecord:
    """Writes a record in another format.

    record: a file or a Record. path: file to write. format: hdf5, mat5, mat73, csv, uff (binary), uff-ascii, rpc
    (floats) or rpc-short (16-bit integers); default: by the ending of path. rate: sample rate [Hz] of files that do
    not tell it. A file of any length is read and written block by block.

    Result, a WrittenRecord: path, samples, warnings (what the format cannot hold).
    Raises InputError for a file that is no record and for an ending that is none, ComputationError where the disk is
    full or progress stops; its message then names the file with the first samples. Source: docs/howto/record.md.
    C++: tasks::convert_record in hydrapod/tasks/measurement.hpp.
    """
    return _rewrite("convert", record, path, progress, format=format, rate=rate)


def cut_record(record: Union[Path, Record], path: Path, *, from_: Optional[Quantity] = None,
               to: Optional[Quantity] = None, channels: Texts = (), role: Optional[str] = None,
               direction: Optional[str] = None, format: Optional[str] = None, rate: Optional[Quantity] = None,
               progress: Optional[Progress] = None) -> WrittenRecord:
    """Writes a part of a record: a time range, some channels.

    from_: first time, to: time before which it ends [s], on the clock of the record; default: start and end.
    channels: names, * for any text; default: all. role: excitation, drive, response or other. direction: x … rz,
    -x … -rz, leg 1 … leg 6. record, path, format, rate: see convert_record().

    Result, a WrittenRecord: path, samples, warnings.
    Raises as convert_record(), and InputError where no channel matches or no sample lies in the range.
    Source: docs/howto/record.md. C++: tasks::cut_record in hydrapod/tasks/measurement.hpp.
    """
    return _rewrite("cut", record, path, progress, **{
        "from": from_, "to": to, "channels": _checks.words(channels, "channels"), "role": role, "direction": direction,
        "format": format, "rate": rate})


def resample_record(record: Union[Path, Record], path: Path, new_rate: Quantity, *, format: Optional[str] = None,
                    rate: Optional[Quantity] = None, progress: Optional[Progress] = None) -> WrittenRecord:
    """Writes a record with another sample rate [Hz], through a linear-phase anti-alias filter.

    new_rate: [Hz]. record, path, format, rate: see convert_record().

    Result, a WrittenRecord: path, samples, warnings.
    Raises as convert_record(), and InputError for a rate more than 1:10000 from that of the record.
    Source: docs/howto/record.md. C++: tasks::resample_record in hydrapod/tasks/measurement.hpp.
    """
    if new_rate is None:
        raise TypeError("new_rate: expected a sample rate, got None")
    return _rewrite("resample", record, path, progress, new_rate=new_rate, format=format, rate=rate)


def _rewrite(how: str, record: Union[Path, Record], path: Path, progress: Optional[Progress],
             **given: Any) -> WrittenRecord:
    with files_of(record) as files:
        return WrittenRecord(*_core.rewrite_record(
            how, _checks.options(file=_only(files, "record"), output=_checks.output(path, "path", files[0]), **given), progress))


def plot_record(record: Union[Path, Record], path: Path, *, channels: Texts = (), rate: Optional[Quantity] = None,
                progress: Optional[Progress] = None) -> List[str]:
    """Draws time histories and spectra of a record as a picture, .svg, .png or .pdf.

    path: the picture, drawn by gnuplot as `hydrapod record plot` does. channels: names; default: the first 24.
    record, rate [Hz]: see convert_record(). Result: warnings, a list of sentences.
    Raises InputError for names that the record does not have, ComputationError without gnuplot or samples, and where
    progress stops. Source: docs/howto/record.md. C++: tasks::plot_record in hydrapod/tasks/measurement.hpp.
    """
    with files_of(record) as files:
        shown, there, warnings = _core.plot_record(
            _checks.options(file=_only(files, "record"), output=_checks.output(path, "path", files[0]),
                            channels=_checks.words(channels, "channels"), rate=rate), progress)
    left = [f"the first {shown} of {there} channels are shown; channels chooses others"] \
        if not channels and shown < there else []
    return [*warnings, *left]


def verify_record(path: Path, *, progress: Optional[Progress] = None) -> VerifiedRecord:
    """Compares the checksum of a record with its channels and samples.

    path: a file. Result, a VerifiedRecord: checksum (holds, differs or none), samples, channels, warnings.
    Raises InputError for a file that cannot be read, ComputationError where progress stops.
    Source: docs/howto/record.md. C++: tasks::verify_record in hydrapod/tasks/measurement.hpp.
    """
    name = _checks.path(path, "path")
    return VerifiedRecord(name, *_core.verify_record(name, progress))


def recover_record(damaged: Path, to: Path, *, format: Optional[str] = None, rate: Optional[Quantity] = None,
                   progress: Optional[Progress] = None) -> RecoveredRecord:
    """Writes what can be read of `damaged`, which stays as it is, to `to`.

    damaged: a file. to: the new one. format, rate [Hz]: see convert_record(). Samples are taken from the first one
    on, up to the damage.

    Result, a RecoveredRecord: path, samples, declared, unfinished, has_checksum, checksum, uneven, warnings.
    Raises InputError where not one sample can be read, ComputationError where the disk is full or progress stops.
    Source: docs/howto/record.md. C++: data::recover_record in hydrapod/data/processing.hpp.
    """
    given = _checks.path(damaged, "damaged")
    return RecoveredRecord(*_core.recover_record(
        _checks.options(file=given, output=_checks.output(to, "to", given), format=format, rate=rate), progress))
