#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

namespace fathom {

/// Where a plane that comes from outside first meets a solid.
struct Contact {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  bool on_face = false;  ///< a flat face lies in the plane, so that the section there has an area
};

/// A body of known volume, in its own coordinates (millimetres, the middle of its extents at the origin).
class Solid {
 public:
  virtual ~Solid() = default;

  /// Negative inside, positive outside, zero on the surface, and never larger in magnitude than the distance to the
  /// surface. It changes by at most the distance moved, so a ball of that radius lies on one side.
  virtual double distance_bound_mm(const Eigen::Vector3d& x_mm) const = 0;

  /// The point of the solid that lies farthest along `direction` (a unit vector); the plane through it has all of the
  /// solid behind it, to 1e-9 mm.
  virtual Contact contact(const Eigen::Vector3d& direction) const = 0;

  double volume_mm3() const { return volume_mm3_; }
  double area_mm2() const { return area_mm2_; }
  /// Of a ball about the origin that holds the solid.
  double radius_mm() const { return radius_mm_; }

 protected:
  Solid(double volume_mm3, double area_mm2, double radius_mm)
      : volume_mm3_(volume_mm3), area_mm2_(area_mm2), radius_mm_(radius_mm) {}

 private:
  double volume_mm3_;
  double area_mm2_;
  double radius_mm_;
};

/// x^2/a^2 + y^2/b^2 + z^2/c^2 <= 1. Volume exact; area by quadrature to 1e-6.
std::unique_ptr<Solid> make_ellipsoid(const Eigen::Vector3d& semi_axes_mm);

/// Upright: base of `radius_mm` at z = -height_mm / 2, tip at z = +height_mm / 2. Volume and area exact.
std::unique_ptr<Solid> make_cone(double radius_mm, double height_mm);

/// Volume and area exact.
std::unique_ptr<Solid> make_box(const Eigen::Vector3d& half_sizes_mm);

/// A displacement along z that depends on x and y only, and so keeps every volume:
/// z += x2 x^2 + x3 x^3 + y2 y^2 + y3 y^3 + shift.
struct Bend {
  double x2 = 0.0;  ///< 1/mm
  double x3 = 0.0;  ///< 1/mm^2
  double y2 = 0.0;  ///< 1/mm
  double y3 = 0.0;  ///< 1/mm^2
  double shift_mm = 0.0;
};

/// An ellipsoid whose points were displaced by `bend`. Volume exact, that of the ellipsoid; area by quadrature to 1e-6.
std::unique_ptr<Solid> make_bent_ellipsoid(const Eigen::Vector3d& semi_axes_mm, const Bend& bend);

/// A cone that grows out of a ball: its axis passes through the ball's centre.
struct Spike {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, from the ball's centre to the tip
  double length_mm = 0.0;                                ///< from the ball's centre to the tip, beyond the ball
  double half_angle_rad = 0.0;                           ///< at the tip; length * tan(half angle) < the ball's radius
};

/// A ball with spikes that do not meet outside of it. Volume and area exact: a spike adds the cone above the circle in
/// which it leaves the ball, less the ball's cap above that circle.
std::unique_ptr<Solid> make_spiked_ball(const Eigen::Vector3d& centre_mm, double radius_mm, std::vector<Spike> spikes);

/// A round rod with a round end that grows out of a ball: its axis starts at the ball's centre.
struct Limb {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, from the ball's centre
  double length_mm = 0.0;                                ///< from the ball's centre to that of the round end
  double radius_mm = 0.0;                                ///< less than the ball's
};

/// A smaller ball that grows out of a ball: the two spheres meet in a circle.
struct Knob {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, from the ball's centre
  double distance_mm = 0.0;                              ///< of the centres, less than the sum of the radii
  double radius_mm = 0.0;                                ///< less than the ball's
};

/// A ball with limbs and knobs that do not meet outside of it. Volume and area exact: a limb adds the rod above the
/// circle in which it leaves the ball and the half ball at its end, less the ball's cap above that circle; a knob adds
/// its own ball less the lens that it shares with the other.
std::unique_ptr<Solid> make_limbed_ball(const Eigen::Vector3d& centre_mm, double radius_mm, std::vector<Limb> limbs,
                                        std::vector<Knob> knobs = {});

/// A solid, moved.
struct PlacedSolid {
  std::shared_ptr<const Solid> solid;
  Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();  ///< of the solid's own origin
};

/// Solids that do not meet, at least one, taken as one. Its extents need not be about the origin. Volume and area exact
/// where the parts' are.
std::shared_ptr<const Solid> make_group(std::vector<PlacedSolid> parts);

/// The same solids, moved together so that the middle of their extents is at the origin.
std::vector<PlacedSolid> centred(std::vector<PlacedSolid> parts);

}  // namespace fathom
