#include "hydrapod/modal/energy.hpp"

namespace hydrapod::modal {

namespace {

using Vector7 = dynamics::Vector7;

/// Energies of one real shape, not yet shares: twice T at ω = 1, twice V.
struct Energies {
  EnergyShares parts{};
  double total_strain{};  ///< φᵀ K φ, geometric part included

  Energies& operator+=(const Energies& other) {
    parts.platform += other.parts.platform;
    parts.legs += other.parts.legs;
    parts.oil += other.parts.oil;
    parts.guide_sleeve += other.parts.guide_sleeve;
    parts.piston_ring += other.parts.piston_ring;
    parts.preload += other.parts.preload;
    total_strain += other.total_strain;
    return *this;
  }
};

template <int flexible>
Energies energies(const LinearModel& model, const Eigen::Ref<const ModelVector>& shape) {
  Energies e;
  const Vector6 q = shape.head<6>();
  e.parts.platform = q.cwiseProduct(model.platform_mass * q);
  double geometric = 0.0;
  for (int i = 0; i < model::leg_count; ++i) {
    const auto& leg = model.legs[i];
    Vector7 x = Vector7::Zero();
    x.head<3>() = model.J[i] * q;
    if constexpr (flexible > 0) x.segment<flexible>(3) = shape.segment<flexible>(6 + flexible * i);
    e.parts.legs[i] = x.dot(leg.M * x);
    const double s = leg.s_x.dot(x);
    e.parts.oil[i] = leg.k_h * s * s;
    e.parts.guide_sleeve[i] = flexible > 0 ? leg.k_s * (leg.d_x * x).squaredNorm() : 0.0;
    e.parts.piston_ring[i] = flexible > 2 ? leg.k_g * x.tail<2>().squaredNorm() : 0.0;
    geometric -= e.parts.oil[i] + e.parts.guide_sleeve[i] + e.parts.piston_ring[i];
  }
  e.total_strain = shape.dot(model.K * shape);
  e.parts.preload = geometric + e.total_strain;
  return e;
}

Energies energies(const LinearModel& model, const Eigen::Ref<const ModelVector>& shape) {
  switch (model.kind) {
    case dynamics::ModelKind::rigid:
      return energies<0>(model, shape);
    case dynamics::ModelKind::guide:
      return energies<2>(model, shape);
    case dynamics::ModelKind::full:
      return energies<4>(model, shape);
  }
  return {};
}

EnergyShares shares(const LinearModel& model, const Energies& energies) {
  EnergyShares share = energies.parts;
  const double kinetic = share.platform.sum() + share.legs.sum();
  share.platform /= kinetic;
  share.legs /= kinetic;
  const double elastic = share.oil.sum() + share.guide_sleeve.sum() + share.piston_ring.sum();
  share.oil /= elastic;
  share.guide_sleeve /= elastic;
  share.piston_ring /= elastic;
  const bool preloaded = model.statics.iterations > 0;  // else the difference is rounding only
  share.preload = preloaded ? share.preload / elastic : 0.0;
  return share;
}

}  // namespace

std::vector<EnergyShares> energy_shares(const LinearModel& model,
                                        const Eigen::Ref<const ModelMatrix>& shapes) {
  std::vector<EnergyShares> list(shapes.cols());
  for (int k = 0; k < shapes.cols(); ++k) list[k] = shares(model, energies(model, shapes.col(k)));
  return list;
}

EnergyShares energy_shares(const LinearModel& model, const ModelVector& real,
                           const ModelVector& imaginary) {
  Energies sum = energies(model, real);
  sum += energies(model, imaginary);
  return shares(model, sum);
}

}  // namespace hydrapod::modal
