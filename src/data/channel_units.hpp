#pragma once
/// Units as measuring programs write them, made SI.

#include <string>
#include <string_view>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "notes.hpp"

namespace hydrapod::data {

struct ChannelUnit {
  double factor{1.0};        ///< sample in SI = factor × sample in the file
  std::string unit{};        ///< what Channel::unit becomes
  bool known{true};          ///< false: neither SI nor convertible, kept as it is
  std::string left_aside{};  ///< of what was written: no part of a unit
};

/// "g" is the acceleration of gravity here, also in the jerk "g/s", and "mg" a thousandth of it,
/// "Nm" a newton metre, "ms-2" m/s², "m/s**2" too, "sec" a second; "-" is "1". "ft-lb" and the like
/// are moments. What says how a pressure is counted ("bar(g)", "psia") or which value of a
/// vibration it is ("m/s2 pk") is left aside.
ChannelUnit channel_unit(std::string_view written);

/// "lb", "lbs": of a force they are lbf.
bool is_pounds(std::string_view written);
/// What is said then.
std::string pounds_of_force(std::string_view written);
/// Does the name of a channel say that it is a force?
bool is_force(const std::string& name);

/// Gives `channel` its unit and returns the factor of its samples. A conversion is noted, and a
/// unit that is not known; `written` is what the file has, if it is to be named.
double use_unit(Channel& channel, const ChannelUnit& unit, const std::string& written,
                Notes& notes);

/// Turns the units of `channels`, as the file has them, into SI and returns the factors of their
/// samples. What was converted is noted, and what is not understood too, unless hydrapod wrote the
/// file. "lb" of a channel that is a force by its name, or an excitation, is lbf.
std::vector<double> to_si(std::vector<Channel>& channels, Notes& notes, bool by_hydrapod);

/// Names as a record wants them: none empty, one line, unique ("pressure", "pressure (2)").
void make_names_unique(std::vector<Channel>& channels);

/// Text of a file as valid UTF-8; bytes that are none are taken for Latin-1. Control characters
/// become blanks, in `several_lines` only those that are no line ends or tabulators.
std::string clean_text(std::string_view text, bool several_lines = false);

}  // namespace hydrapod::data
