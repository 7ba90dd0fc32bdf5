#pragma once
#include <string>

#include "pbrt/media/medium_spectra.h"
#include "pbrt/media/thermal_emission.h"

namespace pbrt {

struct NanoVdbRequest {
    std::string path;
    std::string densityName, temperatureName;  ///< of grids in the file; the second is optional
    ThermalEmission thermal;
};

/// Medium of a sparse density grid from a NanoVDB file, which multiplies absorption and scattering. The grid's own
/// transformation maps to medium space. Values are at integer index coordinates, interpolated trilinearly; negative
/// densities count as 0. The medium extends one voxel beyond the active voxels. A temperature grid makes it emit.
///
/// Throws UserError (no location) if the file is unreadable, lacks the density, or holds invalid densities.
std::unique_ptr<Medium> MakeNanoVdbMedium(const NanoVdbRequest &request, MediumSpectra spectra, Float g,
                                          const Transform &renderFromMedium);

}  // namespace pbrt
