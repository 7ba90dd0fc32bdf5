#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "pbrt/build/built_scene.h"
#include "pbrt/images/image.h"
#include "support/statistics.h"

namespace pbrt::test {

/// The settings of one render in a test; all others are those of the scene.
struct RenderRequest {
    std::string file;
    BuildOptions build;
    bool floatFilm = true;  ///< write 32-bit floats whatever savefp16 is
};

struct Rendered {
    Image image;  ///< the first channels are R, G, B
    nlohmann::ordered_json lightReport;
    double seconds = 0;
    std::vector<Diagnostic> diagnostics;
    std::vector<std::pair<std::string, Image>> sideImages;  ///< Integrator::SideImages
};

/// Reads, builds and renders in this process; throws UserError. All light samplers of the build are registered.
Rendered RenderScene(const RenderRequest &request);

/// The same for a scene given as text.
Rendered RenderText(const std::string &text, const BuildOptions &options = {});

/// Means over tiles of `size` pixels (the last ones may be smaller), R, G, B interleaved, row-major.
std::vector<double> TileMeans(const Image &image, int size);

/// Statistics of a channel over all pixels.
RunningStatistics ChannelStatistics(const Image &image, int channel = 1);

/// Statistics of the means of the green channel, of renders with the seeds 1 to 8.
RunningStatistics MeansOverSeeds(const std::string &text);

/// True if the pixels of the images, which have one resolution and format, have equal bits.
bool SameBits(const Image &a, const Image &b);

/// Folder of the real scenes, ending in "/"; empty if absent. Prints the places that were searched.
std::string RealScenes();

}  // namespace pbrt::test
