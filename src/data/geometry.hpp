#pragma once
/// What files of other programs say of measuring points, in the headers of all formats of records.

#include <string>
#include <vector>

#include "hydrapod/data/record.hpp"
#include "notes.hpp"

namespace hydrapod::data {

/// Keys of the two texts below.
inline constexpr const char* geometry_name = "geometry";
inline constexpr const char* channel_texts_name = "channel_texts";

/// Entities and lines of text of the channels that have some, as a JSON list in one line; empty
/// where there are none.
std::string channel_texts_json(const std::vector<Channel>& channels);

/// Reads geometry_json() and channel_texts_json() back into `header`, whose channels are there
/// already. What cannot be read is noted and left out.
void settle_geometry(const std::string& geometry, const std::string& channel_texts, Notes& notes,
                     RecordHeader& header);

}  // namespace hydrapod::data
