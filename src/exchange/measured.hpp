#pragma once
/// What statements of how far a file is from the machine share. Private to the module.

#include "hydrapod/exchange/exchange.hpp"

namespace hydrapod::exchange {

/// "within 3.1e-14 of …"; held exactly up to `exact_to`.
ParityLine measured(const std::string& what, double difference, const std::string& beside,
                    double exact_to = 1e-9);

/// Of A, from balanced states: pressures stand beside lengths, and slow poles would be rounded
/// away.
Eigen::VectorXcd eigenvalues_of(const StateSpace& system);

/// The largest relative difference of the `count` lowest frequencies, from squares ω² in any order;
/// 1 where one of both is unstable alone.
double frequency_difference(Eigen::VectorXd own, Eigen::VectorXd held, Eigen::Index count);

}  // namespace hydrapod::exchange
