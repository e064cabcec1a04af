#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Core>

#include "acquisition/recording.h"

namespace fathom {

enum class PolhemusModel { kFastrak, kPatriot, kLiberty };

/// "FASTRAK".
const char* name_of(PolhemusModel model);

/// Sensors that an instrument can have: stations are numbered from 1 to this.
int most_stations(PolhemusModel model);

/// How an instrument was told to send its records.
struct PolhemusFormat {
  PolhemusModel model = PolhemusModel::kLiberty;
  bool text = false;       ///< lines of text; else binary
  double unit_mm = 10.0;   ///< centimetres, which the driver asks for; 25.4 where the instrument sends inches
  bool distortion = true;  ///< PATRIOT and LIBERTY: whether records state the distortion
};

/// One measurement of one sensor, as sent.
struct PolhemusReading {
  int station = 0;  ///< from 1
  int error = 0;    ///< the instrument's code, 0 where it sent 0 or a blank
  Eigen::Vector3d position_mm = Eigen::Vector3d::Zero();
  Eigen::Vector4d quaternion = Eigen::Vector4d::Zero();  ///< w, x, y, z, turning sensor to source axes
  std::optional<std::uint32_t> time_ms;                  ///< PATRIOT, LIBERTY: the instrument's clock
  std::optional<std::uint32_t> frame;  ///< PATRIOT, LIBERTY: number of the measurement, shared by its stations
  std::optional<int> distortion;       ///< of the field by metal: 0 for none to 255
};

/// What stands at the beginning of some bytes.
struct PolhemusStep {
  std::size_t used = 0;                    ///< bytes to go on after; 0: more bytes are needed
  std::optional<PolhemusReading> reading;  ///< empty: the bytes used are no record, but noise or part of one
};

/// Finds the record at the beginning of `bytes`, or how many bytes there certainly begin none.
///
/// PATRIOT and LIBERTY, binary: "PA" or "LY", station, command ('P' or 'C'), error, reserved, size of what follows (2
/// bytes); time in ms and frame count (4 bytes each), distortion (4 bytes, where asked for), x, y, z, and quaternion
/// w, x, y, z (IEEE floats), a blank; low bytes first. FASTRAK, binary: '0', station as digit, error, x, y, z, w, x,
/// y, z, carriage return, line feed. Text: station with two digits, command or blank, error (FASTRAK: '0', station,
/// error), the same numbers, carriage return, line feed. A record that was cut and runs into the next one is told by
/// its end; records bear no checksum, so that a number altered on the line may pass.
PolhemusStep read_polhemus(std::span<const std::uint8_t> bytes, const PolhemusFormat& format);

/// The pose sensor -> source of a reading: `OK` only where the instrument reports no error, all numbers are finite,
/// the quaternion has length 1 (to 1e-3 in the matrix, see is_rigid), the position is within 10 m of the source and
/// the distortion at most `most_distortion`. Otherwise the status says why not: "OUT_OF_VOLUME",
/// "INSTRUMENT_ERROR_a" (its letter or number), "NOT_FINITE", "NOT_RIGID", "DISTORTED"; the matrix is then the
/// identity where it cannot be made.
Pose polhemus_pose(const PolhemusReading& reading, int most_distortion);

}  // namespace fathom
