#pragma once
/// What files of frequency responses hold besides H, so that identification of what is read gives
/// what it gives of what was written.

#include <optional>
#include <string>
#include <vector>

#include "hydrapod/data/frequency_response.hpp"
#include "notes.hpp"
#include "record_comments.hpp"

namespace hydrapod::data {

/// Names of the parts in Universal Files and tables.
namespace response_part {
inline constexpr const char* variance = "variance";
inline constexpr const char* noise = "noise";
inline constexpr const char* input_factor = "input factor";
inline constexpr const char* beside_axis = "beside the axis";
}  // namespace response_part

/// H(iω) of the responses. Throws std::invalid_argument where it is not known.
const PerLine<Eigen::MatrixXcd>& required_on_axis(const FrequencyResponses& responses);

/// Comment lines: the header of a record whose channels are the outputs and then the inputs, and
/// "responses", one JSON object with what is not said per line.
std::string response_comments(const FrequencyResponses& responses);

/// Responses without lines, as response_comments() described them. None where there is no such
/// description, or, with a note, where it cannot be used.
std::optional<FrequencyResponses> described_responses(const RecordComments& comments, Notes& notes);

/// Takes over all that is not said per line, but not the channels. Frequencies of few digits become
/// the lines of the window; what does not fit is left aside with a note.
void take_description(const FrequencyResponses& described, Notes& notes,
                      FrequencyResponses& responses);

/// What a file says of errors, a matrix per line or nothing; NaN where an entry is missing.
struct WrittenErrors {
  std::vector<Eigen::MatrixXcd> noise{}, input_factor{};  ///< lower triangles
  std::vector<Eigen::MatrixXd> variance{};                ///< outputs × inputs
};

/// Noise and input factor if they are complete and can be covariances; else from the variances,
/// V_oi ≈ n_o q_i by their means over rows and columns, if these are complete. What is left aside
/// is noted.
void take_errors(WrittenErrors written, Notes& notes, FrequencyResponses& responses);

/// H becomes what stands beside the axis, if it is complete; else the shift is dropped, with a
/// note.
void take_beside_axis(std::vector<Eigen::MatrixXcd> beside, Notes& notes,
                      FrequencyResponses& responses);

}  // namespace hydrapod::data
