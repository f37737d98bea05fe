// SPDX-License-Identifier: BSD-3-Clause
#include "world/media_list.hpp"

#include "optics/media_presets.hpp"

namespace straytrace {

std::vector<KnownMedium> known_media() {
  std::vector<KnownMedium> all;
  for (MediumPreset const& p : medium_presets())
    for (double const wavelength : {1064e-9, 1550e-9})
      if (auto const index = index_of(p, wavelength)) {
        all.push_back({std::string(p.name), std::string(p.source), *index, wavelength});
        break;
      }
  return all;
}

}  // namespace straytrace
