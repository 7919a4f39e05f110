// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hexaplast/mesh/blade.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/require.hpp"
#include "hexaplast/base/error.hpp"

namespace hexaplast {
namespace {

using Point = Sweep::Point;
using End = Sweep::End;
__extension__ typedef __int128 Wide;

constexpr int kBits = 32;             // the box of the body has 2^32 to 2^33 spacings
constexpr double kGreatest = 0x1p60;  // coordinate that can be rounded
constexpr double kBend = 0.1;         // at most, of the mean link, in a part of a step
constexpr double kMargin = 0.01;      // of the mean link, beyond all rounding

/// A point in space and, at one of two moments, in time.
struct Event {
  Point at;
  bool is_late, is_of_blade;
};

int sign(Wide number) { return (number > 0) - (number < 0); }

std::array<Wide, 3> cross(const Point& a, const Point& b) {
  std::array<Wide, 3> product;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    product[i] = Wide{a[j]} * b[k] - Wide{a[k]} * b[j];
  }
  return product;
}

/// Sign of a . b, exact for entries below 2^124 and 2^61: upper and lower 64 bits of those of a are multiplied apart.
int sign_of_product(const std::array<Wide, 3>& a, const Point& b) {
  Wide upper = 0, lower = 0;
  for (int i = 0; i < 3; ++i) {
    upper += (a[i] >> 64) * b[i];
    lower += Wide{static_cast<std::uint64_t>(a[i])} * b[i];
  }
  upper += lower >> 64;
  return upper != 0 ? sign(upper) : static_cast<std::uint64_t>(lower) != 0;
}

/// Sign of the determinant of the five rows (x, y, z, t, 1) of all events but one; those of the blade are displaced by
/// d = (eps, eps^2, eps^3).
///
/// Any five have both times. Subtracting at each time the row of the first event from those of the others leaves three
/// rows r_k = (difference, 0, 0). So the determinant is that of these differences, up to the sign of the order and of
/// the two rows (t, 1) that are left. A row is displaced by s_k d, s_k = -1, 0 or 1; what is of second order in d
/// vanishes, since two rows would be parallel to d:
///
///   det(r_k + s_k d) = r_0 . (r_1 x r_2) + d . (s_0 r_1 x r_2 + s_1 r_2 x r_0 + s_2 r_0 x r_1)
///
/// With differences up to 2^61, entries of cross products are at most 2^123 and those of the displacement 3 * 2^123:
/// all are exact in 127 bits and a sign.
int orientation(const std::array<Event, 6>& events, int omitted) {
  std::array<const Event*, 2> first{};  // of each time
  std::array<Point, 3> row;
  std::array<int, 3> displaced;
  int num_rows = 0, order = 1;
  for (int k = 0; k < 6; ++k) {
    if (k == omitted) continue;
    const Event& event = events[k];
    if (const Event*& base = first[event.is_late]; !base) {
      base = &event;
      if (num_rows % 2 == 1) order = -order;  // this row passes those before it, to the upper end
      continue;
    }
    const Event& base = *first[event.is_late];
    for (int i = 0; i < 3; ++i) row[num_rows][i] = event.at[i] - base.at[i];
    displaced[num_rows++] = int{event.is_of_blade} - int{base.is_of_blade};
  }
  if (first[0] > first[1]) order = -order;  // events lie in one array

  const std::array<std::array<Wide, 3>, 3> minors = {cross(row[1], row[2]), cross(row[2], row[0]),
                                                     cross(row[0], row[1])};
  int side = sign_of_product(minors[0], row[0]);
  for (int i = 0; i < 3 && side == 0; ++i)
    side = sign(minors[0][i] * displaced[0] + minors[1][i] * displaced[1] + minors[2][i] * displaced[2]);
  return order * side;
}

/// Whether a triangle of a link (the first three events) and one of a blade meet within both.
///
/// Six points (x, y, z, t, 1) of five numbers have one linear relation, whose coefficients are the determinants without
/// one of them, with alternating signs. It equates a point of the one triangle with one of the other if the
/// coefficients have one sign for the first three and the other one for the others.
bool have_common_point(const std::array<Event, 6>& events) {
  const int first = orientation(events, 0);
  if (first == 0) return false;
  for (int k = 1; k < 6; ++k) {
    const int alternating = k % 2 == 0 ? 1 : -1, side = k < 3 ? 1 : -1;
    if (orientation(events, k) * alternating * side != first) return false;
  }
  return true;
}

std::array<std::array<Event, 3>, 2> triangles(const Sweep& line, bool is_of_blade) {
  const Event p0{line.p.before, false, is_of_blade}, q0{line.q.before, false, is_of_blade};
  const Event p1{line.p.after, true, is_of_blade}, q1{line.q.after, true, is_of_blade};
  return {{{p0, q0, q1}, {p0, q1, p1}}};
}

std::int64_t least(const Sweep& line, int i) {
  return std::min({line.p.before[i], line.q.before[i], line.p.after[i], line.q.after[i]});
}

std::int64_t greatest(const Sweep& line, int i) {
  return std::max({line.p.before[i], line.q.before[i], line.p.after[i], line.q.after[i]});
}

double distance(const Point& a, const Point& b) {
  double squared = 0;
  for (int i = 0; i < 3; ++i) squared += std::pow(static_cast<double>(b[i] - a[i]), 2);
  return std::sqrt(squared);
}

/// Of the displacements of both ends.
double difference(const Sweep& line) {
  Point p, q;
  for (int i = 0; i < 3; ++i) {
    p[i] = line.p.after[i] - line.p.before[i];
    q[i] = line.q.after[i] - line.q.before[i];
  }
  return distance(p, q);
}

std::int64_t nearest_integer(double number) {  // halves away from zero
  return static_cast<std::int64_t>(number + std::copysign(0.5, number));
}

Point at(const End& end, double fraction) {
  Point point;
  for (int i = 0; i < 3; ++i)
    point[i] = end.before[i] + nearest_integer(fraction * static_cast<double>(end.after[i] - end.before[i]));
  return point;
}

Vec3 place(const End& end, double time) {
  Vec3 place;
  for (int i = 0; i < 3; ++i)
    place[i] = std::lerp(static_cast<double>(end.before[i]), static_cast<double>(end.after[i]), time);
  return place;
}

/// Where a link is met, as a fraction of it. Link and segment span no volume at that time, which is bisected for; of
/// several such times the one at which both meet counts. Lines that are parallel throughout meet in the middle.
double crossing(const Sweep& link, const Sweep& segment) {
  constexpr int kSamples = 8, kBisections = 12;
  const auto along = [](const Sweep& line, double time) -> Vec3 { return place(line.q, time) - place(line.p, time); };
  const auto volume = [&](double time) {
    return along(link, time).cross(along(segment, time)).dot(place(segment.p, time) - place(link.p, time));
  };
  double found = 0.5, least = std::numeric_limits<double>::infinity();  // how far beyond an end they are nearest
  for (int k = 0; k < kSamples; ++k) {
    double from = k / double{kSamples}, to = (k + 1) / double{kSamples};
    for (int step = 0; step < kBisections && volume(from) * volume(to) <= 0; ++step) {
      const double middle = (from + to) / 2;
      (volume(from) * volume(middle) > 0 ? from : to) = middle;
    }
    const double time = (from + to) / 2;
    const Vec3 u = along(link, time), v = along(segment, time), w = place(segment.p, time) - place(link.p, time);
    const Vec3 normal = u.cross(v);
    if (!(normal.squaredNorm() > 0)) continue;
    const double of_link = w.cross(v).dot(normal) / normal.squaredNorm(),
                 of_segment = w.cross(u).dot(normal) / normal.squaredNorm(),
                 apart = std::abs(w.dot(normal)) / normal.norm() / u.norm();
    const double beyond = std::max(std::abs(of_link - 0.5), std::abs(of_segment - 0.5)) - 0.5;
    if (const double miss = std::max(beyond, 0.0) + apart; miss < least) {
      least = miss;
      found = of_link;
    }
  }
  return std::clamp(found, 0.0, 1.0);
}

End between(const End& end, double from, double to) { return {at(end, from), at(end, to)}; }

}  // namespace

bool meet(const Sweep& link, const Sweep& segment) {
  for (int i = 0; i < 3; ++i)
    if (greatest(link, i) < least(segment, i) || greatest(segment, i) < least(link, i)) return false;
  for (const std::array<Event, 3>& a : triangles(link, false))
    for (const std::array<Event, 3>& b : triangles(segment, true))
      if (have_common_point({a[0], a[1], a[2], b[0], b[1], b[2]})) return true;
  return false;
}

BladeCut::BladeCut(const HexMesh& initial, const Joints& joints) : centres_(initial.hexahedra().size()) {
  for (int joint = 0; joint < joints.count(); ++joint)
    for (const int other : joints.hexahedra(joint).subspan(1))
      links_.push_back({joint, joints.hexahedra(joint).front(), other});
  if (links_.empty()) return;
  const PointArray& x = initial.positions();
  const Vec3 lower = x.colwise().minCoeff(), upper = x.colwise().maxCoeff();
  origin_ = (lower + upper) / 2;
  spacing_ = std::ldexp(1.0, std::ilogb((upper - lower).maxCoeff()) - kBits);  // a power of two: scaling is exact
  for (int e = 0; e < initial.num_elements(); ++e) centres_[e] = centre(initial.hexahedra()[e], e, x, x);
  for (const Link& link : links_) mean_length_ += distance(centres_[link.first].before, centres_[link.second].before);
  mean_length_ /= static_cast<double>(links_.size());
}

double BladeCut::tolerance() const { return kBend * mean_length_ * spacing_; }

const std::vector<int>& BladeCut::opened(std::span<const Hexahedron> hexahedra, ConstPoints x_before,
                                         ConstPoints x_after, std::span<const BladeAt> blade,
                                         std::span<const unsigned char> is_open) {
  met_.clear();
  opened_.clear();
  crossings_.clear();
  points_.clear();
  Eigen::AlignedBox3d box;
  for (const BladeAt& moment : blade) {
    require_rows("BladeCut::opened", "blade", moment.points, blade.front().points.rows());
    for (Eigen::Index k = 0; k < moment.points.rows(); ++k) {
      const Vec3 point = moment.points.row(k);
      points_.push_back(on_lattice(point, "blade: point", k));
      box.extend(point);
    }
  }
  if (points_.empty() || links_.empty()) return opened_;
  find_near(hexahedra, x_before, x_after, box, is_open);
  chain_.resize(points_.size() / blade.size());
  for (std::size_t moment = 1; moment < blade.size() && !near_.empty(); ++moment) {
    for (std::size_t k = 0; k < chain_.size(); ++k)
      chain_[k] = {points_[(moment - 1) * chain_.size() + k], points_[moment * chain_.size() + k]};
    cut(blade[moment - 1].fraction, blade[moment].fraction);
  }
  std::ranges::sort(met_);
  for (const auto& [joint, place] : met_) {
    if (!opened_.empty() && opened_.back() == joint) continue;  // it may have several links
    opened_.push_back(joint);
    crossings_.push_back(place);
  }
  return opened_;
}

Point BladeCut::on_lattice(const Vec3& position, const char* whose, Eigen::Index number) const {
  Point point;
  for (int i = 0; i < 3; ++i) {
    const double scaled = (position[i] - origin_[i]) / spacing_;
    if (!(std::abs(scaled) < kGreatest))
      throw InputError(fmt::format("{} {} is at {} {} {} m, must be finite and nearer than {:.3g} m to the body", whose,
                                   number, position[0], position[1], position[2], kGreatest * spacing_));
    point[i] = nearest_integer(scaled);
  }
  return point;
}

End BladeCut::centre(const Hexahedron& corners, Eigen::Index number, ConstPoints x_before, ConstPoints x_after) const {
  Vec3 before = Vec3::Zero(), after = Vec3::Zero();
  for (const int n : corners) {
    before += x_before.row(n).transpose();
    after += x_after.row(n).transpose();
  }
  return {on_lattice(before / kCorners, "the centre of hexahedron", number),
          on_lattice(after / kCorners, "the centre of hexahedron", number)};
}

/// All closed links but those whose hexahedra stay, throughout the step, beyond one side of the blade's box.
void BladeCut::find_near(std::span<const Hexahedron> hexahedra, ConstPoints x_before, ConstPoints x_after,
                         const Eigen::AlignedBox3d& blade, std::span<const unsigned char> is_open) {
  const double margin = kMargin * mean_length_ * spacing_;
  const Vec3 lower = blade.min().array() - margin, upper = blade.max().array() + margin;
  beyond_of_node_.resize(static_cast<std::size_t>(x_before.rows()));
  for (Eigen::Index n = 0; n < x_before.rows(); ++n) {
    int sides = 0;
    for (int i = 0; i < 3; ++i) {
      const double before = x_before(n, i), after = x_after(n, i);
      const bool is_below = before < lower[i] && after<lower[i], is_above = before> upper[i] && after > upper[i];
      sides = sides << 2 | int{is_below} << 1 | int{is_above};
    }
    beyond_of_node_[static_cast<std::size_t>(n)] = static_cast<unsigned char>(sides);
  }
  beyond_.resize(hexahedra.size());
  for (std::size_t e = 0; e < hexahedra.size(); ++e) {
    unsigned char sides = 0xff;
    for (const int n : hexahedra[e]) sides &= beyond_of_node_[static_cast<std::size_t>(n)];
    beyond_[e] = sides;
  }

  near_.clear();
  is_at_near_link_.assign(hexahedra.size(), 0);
  for (const Link& link : links_)
    if ((beyond_[link.first] & beyond_[link.second]) == 0 && is_open[link.joint] == 0) {
      near_.push_back(link);
      is_at_near_link_[link.first] = is_at_near_link_[link.second] = 1;
    }
  if (near_.empty()) return;
  for (int e = 0; e < std::ssize(hexahedra); ++e)
    if (is_at_near_link_[e] != 0) centres_[e] = centre(hexahedra[e], e, x_before, x_after);
}

/// One part of a step after the other.
void BladeCut::cut(double from, double to) {
  double bend = 0;
  for (const auto& [joint, first, second] : near_)
    bend = std::max(bend, (to - from) * difference({centres_[first], centres_[second]}) / 4);
  for (std::size_t k = 1; k < chain_.size(); ++k) bend = std::max(bend, difference({chain_[k - 1], chain_[k]}) / 4);
  const double num_parts = std::max(1.0, std::ceil(bend / (kBend * mean_length_)));

  chain_part_.resize(chain_.size());
  for (double part = 0; part < num_parts; ++part) {
    const double begin = part / num_parts, end = (part + 1) / num_parts;
    for (std::size_t k = 0; k < chain_.size(); ++k) chain_part_[k] = between(chain_[k], begin, end);
    std::erase_if(near_, [&](const Link& link) {
      const double link_begin = std::lerp(from, to, begin), link_end = std::lerp(from, to, end);
      const Sweep sweep{between(centres_[link.first], link_begin, link_end),
                        between(centres_[link.second], link_begin, link_end)};
      for (std::size_t k = 1; k < chain_.size(); ++k) {
        const Sweep segment{chain_part_[k - 1], chain_part_[k]};
        if (!meet(sweep, segment)) continue;
        met_.emplace_back(link.joint, crossing(sweep, segment));
        return true;
      }
      return false;
    });
  }
}

}  // namespace hexaplast
