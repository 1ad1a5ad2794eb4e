#pragma once
/// base::quantity() without UDUNITS, which the page does not carry: units by the factors that the
/// program wrote into the page (`scales` of editable_json()).

#include "hydrapod/report/json.hpp"

namespace hydrapod::page {

/// From now on these units are known: { SI unit: { unit: factor } }.
void know_units(const report::Json& scales);

}  // namespace hydrapod::page
