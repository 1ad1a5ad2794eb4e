#include "hydrapod/modal/normal_modes.hpp"

#include <algorithm>
#include <array>
#include <type_traits>

namespace hydrapod::modal {

namespace {

constexpr int lanes = 8;  // shapes that go through together, one per SIMD lane
using Numbers = Eigen::Array<double, lanes, 1>;
constexpr std::size_t cache_line = 64;  // arrays of Numbers that begin at one cross none
using Sextet = std::array<Numbers, model::leg_count>;
using Shapes = std::array<Numbers, dynamics::max_dof>;  ///< one Numbers per coordinate

Numbers sum(const Sextet& parts) {
  return parts[0] + parts[1] + parts[2] + parts[3] + parts[4] + parts[5];
}

/// Twice the energies of some shapes, kinetic at ω = 1.
struct alignas(cache_line) Energies {
  Sextet platform, legs, oil, guide_sleeve, piston_ring, bending;
  Sextet base{Numbers::Zero(), Numbers::Zero(), Numbers::Zero(),
              Numbers::Zero(), Numbers::Zero(), Numbers::Zero()};
  Numbers base_mount{Numbers::Zero()};
  Numbers payload{Numbers::Zero()}, payload_elastic{Numbers::Zero()};
  Numbers elastic_and_geometric{Numbers::Zero()};  ///< φᵀ K φ; only where there is preload
};

template <int size>
constexpr std::integral_constant<int, size> fixed{};

/// xᵀ A x for symmetric A. `size`: a number, or fixed<number>.
template <typename Matrix, typename Size>
Numbers quadratic(const Matrix& A, const Numbers* x, Size size) {
  Numbers total = Numbers::Zero();
  for (int i = 0; i < size; ++i) {
    Numbers row = A(i, i) * x[i];
    for (int j = 0; j < i; ++j) row += 2.0 * A(j, i) * x[j];
    total += row * x[i];
  }
  return total;
}

template <int size, typename Row>
Numbers product(const Row& row, const Numbers* x) {
  Numbers total = row[0] * x[0];
  for (int j = 1; j < size; ++j) total += row[j] * x[j];
  return total;
}

/// Motion of the base with coordinates of its own, and of the platform against it.
struct OnBase {
  Sextet base, platform;
};

OnBase on_base(const LinearModel& model, const Shapes& y) {
  OnBase motion;
  for (int d = 0; d < 6; ++d) {
    motion.base[d].setZero();
    motion.platform[d] = y[d];
  }
  for (int k = 0; k < model.base_count(); ++k) {
    const Numbers& q_b = y[model.first_of_base() + k];
    motion.base[model.base_directions[k]] = q_b;
    for (int d = 0; d < 6; ++d) motion.platform[d] -= model.carried_by_base(d, k) * q_b;
  }
  return motion;
}

/// What a base that moves adds to the kinetic energy of a leg with the motion x against it.
template <int size>
Numbers carried_energy(const dynamics::LegOnBase& leg, const std::array<Numbers, size>& x,
                       const Sextet& base) {
  Numbers energy = quadratic(leg.inertia, base.data(), fixed<6>);
  for (int d = 0; d < 6; ++d)
    energy += 2.0 * base[d] * product<size>(leg.momentum.row(d), x.data());
  return energy;
}

/// The leg's share of `e`; `y`: the shapes, `platform`: its motion that the leg sees, `base`: that
/// of a base with coordinates.
template <int flexible>
void add_leg(const LinearModel& model, int i, const Shapes& y, const Numbers* platform, Energies& e,
             const Sextet* base = nullptr) {
  const auto& leg = model.legs[i];
  constexpr int size = 3 + flexible;
  alignas(cache_line) std::array<Numbers, size> x;
  for (int k = 0; k < 3; ++k) x[k] = product<6>(model.J[i].row(k), platform);
  for (int k = 0; k < flexible; ++k) x[3 + k] = y[6 + flexible * i + k];
  e.legs[i] = quadratic(leg.M, x.data(), fixed<size>);
  if (base != nullptr) e.legs[i] += carried_energy<size>(model.legs_on_base[i], x, *base);
  e.oil[i] = leg.k_h * product<size>(leg.s_x, x.data()).square();
  e.guide_sleeve[i].setZero();
  e.piston_ring[i].setZero();
  e.bending[i].setZero();
  if constexpr (flexible > 0) {
    const Numbers along_t = product<size>(leg.d_x.row(0), x.data()),
                  along_2 = product<size>(leg.d_x.row(1), x.data());
    e.guide_sleeve[i] = (leg.k_s + leg.k_contact) * (along_t.square() + along_2.square());
    if (leg.k_contact > 0.0)
      e.guide_sleeve[i] += (leg.contact_root[0] * along_t + leg.contact_root[1] * along_2).square();
    if (leg.bending > 0.0)
      e.bending[i] = leg.bending * (product<size>(leg.F_x.row(0), x.data()).square() +
                                    product<size>(leg.F_x.row(1), x.data()).square());
  }
  if constexpr (flexible > 2) e.piston_ring[i] = leg.k_g * (x[5].square() + x[6].square());
}

template <int flexible>
void add_legs_and_base(const LinearModel& model, const Shapes& y, Energies& e) {
  const auto motion = on_base(model, y);
  for (int i = 0; i < model::leg_count; ++i)
    add_leg<flexible>(model, i, y, motion.platform.data(), e, &motion.base);
  for (int d = 0; d < 6; ++d) {
    e.base[d] = model.base_inertia[d] * motion.base[d].square();
    e.base_mount += model.k_mount[d] * motion.base[d].square();
  }
}

void add_payload(const LinearModel& model, const Shapes& y, Energies& e) {
  for (int k = 0; k < model.payload_count(); ++k) {
    const Numbers& xi = y[model.first_of_payload() + k];
    e.payload += (xi + product<6>(model.payload.col(k), y.data())).square();
    e.payload_elastic += model.payload_omega2[static_cast<std::size_t>(k)] * xi.square();
  }
}

template <int flexible>
Energies energies(const LinearModel& model, const Shapes& y) {
  Energies e;
  for (int i = 0; i < 6; ++i)
    e.platform[i] = y[i] * product<6>(model.platform_mass.col(i), y.data());
  if (model.base_count() > 0) {
    add_legs_and_base<flexible>(model, y, e);
  } else {
    for (int i = 0; i < model::leg_count; ++i) add_leg<flexible>(model, i, y, y.data(), e);
    if (model.base_moves) e.base_mount = quadratic(model.K_mount, y.data(), fixed<6>);
  }
  add_payload(model, y, e);
  if (model.statics.iterations > 0)
    e.elastic_and_geometric = quadratic(model.K, y.data(), model.dof());
  return e;
}

Energies energies(const LinearModel& model, const Shapes& y) {
  switch (model.kind) {
    case dynamics::ModelKind::guide:
      return energies<2>(model, y);
    case dynamics::ModelKind::full:
      return energies<4>(model, y);
    case dynamics::ModelKind::rigid:
      break;
  }
  return energies<0>(model, y);
}

/// Makes shares of the energies.
void normalise(const LinearModel& model, Energies& e) {
  Numbers kinetic = sum(e.platform) + sum(e.legs) + sum(e.base);
  Numbers elastic =
      sum(e.oil) + sum(e.guide_sleeve) + sum(e.piston_ring) + e.base_mount + sum(e.bending);
  if (model.payload_count() > 0) {
    kinetic += e.payload;
    elastic += e.payload_elastic;
  }
  const Numbers per_kinetic = kinetic.inverse();
  const Numbers per_elastic = elastic.inverse();
  for (Sextet* parts : {&e.platform, &e.legs, &e.base})
    for (Numbers& part : *parts) part *= per_kinetic;
  for (Sextet* parts : {&e.oil, &e.guide_sleeve, &e.piston_ring, &e.bending})
    for (Numbers& part : *parts) part *= per_elastic;
  e.base_mount *= per_elastic;
  e.payload *= per_kinetic;
  e.payload_elastic *= per_elastic;
  const bool preloaded = model.statics.iterations > 0;  // else there is nothing but rounding
  if (preloaded) e.elastic_and_geometric = (e.elastic_and_geometric - elastic) * per_elastic;
}

void take_lane(const Energies& shares, int k, EnergyShares& one) {
  for (int i = 0; i < 6; ++i) {
    one.platform[i] = shares.platform[i][k];
    one.legs[i] = shares.legs[i][k];
    one.base[i] = shares.base[i][k];
    one.oil[i] = shares.oil[i][k];
    one.guide_sleeve[i] = shares.guide_sleeve[i][k];
    one.piston_ring[i] = shares.piston_ring[i][k];
    one.bending[i] = shares.bending[i][k];
  }
  one.base_mount = shares.base_mount[k];
  one.payload = shares.payload[k];
  one.payload_elastic = shares.payload_elastic[k];
  one.preload = shares.elastic_and_geometric[k];
}

}  // namespace

std::vector<EnergyShares> energy_shares(const LinearModel& model,
                                        const Eigen::Ref<const ModelMatrix>& shapes) {
  const int count = static_cast<int>(shapes.cols());
  std::vector<EnergyShares> list(count);
  alignas(cache_line) Shapes y;
  Eigen::Map<Eigen::Matrix<double, lanes, Eigen::Dynamic>> rows(y.front().data(), lanes,
                                                                model.dof());
  for (int first = 0; first < count; first += lanes) {
    const int now = std::min(lanes, count - first);
    for (int k = 0; k < lanes; ++k)
      rows.row(k) = shapes.col(first + std::min(k, now - 1)).transpose();
    Energies e = energies(model, y);
    normalise(model, e);
    for (int k = 0; k < now; ++k) {
      take_lane(e, k, list[first + k]);
      list[first + k].leg_type = model.leg_type;
    }
  }
  return list;
}

EnergyShares energy_shares(const LinearModel& model, const ModelVector& real,
                           const ModelVector& imaginary) {
  alignas(cache_line) Shapes y;
  for (int j = 0; j < model.dof(); ++j) {
    y[j].setConstant(real[j]);
    y[j][1] = imaginary[j];
  }
  Energies e = energies(model, y);
  for (Sextet* parts :
       {&e.platform, &e.legs, &e.base, &e.oil, &e.guide_sleeve, &e.piston_ring, &e.bending})
    for (Numbers& part : *parts) part[0] += part[1];
  for (Numbers* part : {&e.base_mount, &e.payload, &e.payload_elastic}) (*part)[0] += (*part)[1];
  e.elastic_and_geometric[0] += e.elastic_and_geometric[1];
  normalise(model, e);
  EnergyShares shares{.leg_type = model.leg_type};
  take_lane(e, 0, shares);
  return shares;
}

}  // namespace hydrapod::modal
