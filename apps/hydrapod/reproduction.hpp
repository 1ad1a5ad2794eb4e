#pragma once
/// How a result was made, so that another can make it again: version and commit of the program,
/// the date, the whole command, and the files it read with their checksums.

#include <string>
#include <vector>

#include "hydrapod/report/json.hpp"
#include "hydrapod/tasks/simulation.hpp"

namespace hydrapod::cli {

void set_command_line(int argc, const char* const* argv);

/// What records say of their origin: program, all arguments, the files read with their checksums.
/// There is no date: the same command writes the same record bit for bit.
tasks::Origin record_origin();

/// "hydrapod 0.1.0, commit 60f3…": with "-changed" where sources were changed after the commit;
/// without a commit where the sources came without one.
const std::string& program_text();

/// A file that this run reads, found among the values of its options.
void note_input(const std::string& option, const std::string& path);

/// `program`, `version`, `commit` (or null), `date` (UTC, ISO 8601; SOURCE_DATE_EPOCH where the
/// environment has it), `command` (all arguments) and `inputs`: `option`, `path`, `bytes` and
/// `sha256` of each file. The checksum is null for a file that was changed or removed while the
/// command ran.
report::Json reproduction();

/// The same in lines of text, for tables in files.
std::string reproduction_text();

/// With the program, as files end by which a later run knows that they are hydrapod's: "… written
/// by hydrapod 0.1.0, commit 60f3…".
std::string origin_text();

/// A command as a shell takes it: "hydrapod rig 'my machine.toml' -o run.h5".
std::string shell_text(const std::vector<std::string>& arguments);

/// SHA-256 of a file's bytes in hexadecimal digits. Throws base::InputError where it cannot be
/// read.
std::string sha256_of_file(const std::string& path);

}  // namespace hydrapod::cli
