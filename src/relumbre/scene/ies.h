/// Photometric profiles in IES LM-63 files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "relumbre/base/vec3.h"

namespace relumbre {

/// Luminous intensity by direction (type C photometry), bilinear between its angles.
/// `candela` is horizontal-major: candela[h * vertical_deg.size() + v], multipliers applied.
struct IesProfile {
  std::vector<float> vertical_deg;    ///< ascending, 0 = where the luminaire points (nadir)
  std::vector<float> horizontal_deg;  ///< ascending; 0..0, 0..90, 0..180 or 0..360 by symmetry
  std::vector<float> candela;
  float peak_candela = 0;  ///< the largest candela value, or 0 to have it searched at every call
  /// Intensity relative to the profile's peak, in [0, 1], towards a unit direction given in the
  /// luminaire's frame (+z along its axis). 0 outside the measured vertical range.
  /// Azimuth runs from +x towards +y. O(log of the angle counts).
  [[nodiscard]] float relative(const Vec3f& local_direction) const;
  [[nodiscard]] float peak() const;
};

/// LM-63-1986, -1991, -1995 and -2002, TILT=NONE, photometry of type C, at most 10^4 angles each
/// way. Candela are multiplied by the candela multiplier and both ballast factors. Throws FileError
/// naming file, line and reason: types A and B and other TILTs are refused by name. Source: IES
/// LM-63-2002, "Standard File Format for the Electronic Transfer of Photometric Data".
IesProfile read_ies(const std::filesystem::path& file);
IesProfile parse_ies(std::string_view text, const std::string& file_name);

}  // namespace relumbre
