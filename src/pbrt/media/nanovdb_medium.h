#pragma once
#include <string>

#include "pbrt/media/medium_spectra.h"
#include "pbrt/media/thermal_emission.h"

namespace pbrt {

/// What a medium of a NanoVDB file is made from.
struct NanoVdbRequest {
    std::string path;
    std::string densityName, temperatureName;  ///< of grids of the file; the second one need not exist
    ThermalEmission thermal;
};

/// A medium whose density is a sparse grid of voxels from a NanoVDB file, placed by the grid's own transformation into
/// the space of the medium; absorption and scattering are multiplied by it. Values stand at whole index coordinates and
/// are interpolated linearly along each axis; negative densities count as 0. The medium ends one voxel beyond the
/// grid's active voxels. A grid of temperatures makes it emit.
///
/// Throws UserError (no location) if the file cannot be read, lacks the density, or holds values that cannot be
/// densities.
std::unique_ptr<Medium> MakeNanoVdbMedium(const NanoVdbRequest &request, MediumSpectra spectra, Float g,
                                          const Transform &renderFromMedium);

}  // namespace pbrt
