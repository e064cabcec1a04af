#include "registration/sound_speed.h"

#include <array>

#include "core/error.h"
#include "core/numbers.h"

namespace fathom {

double water_sound_speed_m_s(double celsius) {
  constexpr double kHottest = 95.0;
  if (!(celsius >= 0.0 && celsius <= kHottest)) {
    throw Error("the water's temperature must be 0 to 95 degrees Celsius, not " + format_real(celsius));
  }
  constexpr std::array<double, 6> kMarczak = {1.402385e3,  5.038813,     -5.799136e-2,
                                              3.287156e-4, -1.398845e-6, 2.787860e-9};
  double speed = 0.0;
  for (std::size_t i = kMarczak.size(); i-- > 0;) speed = speed * celsius + kMarczak[i];
  return speed;
}

DepthCorrection water_correction(double celsius, double face_row_px) {
  // Shown depth = true depth * (assumed speed / true speed), so that tissue's assumed speed shows less by the inverse.
  return {face_row_px, water_sound_speed_m_s(celsius) / kTissueSoundSpeed_m_s};
}

}  // namespace fathom
