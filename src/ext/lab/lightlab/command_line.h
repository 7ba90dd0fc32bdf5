#pragma once
#include "ext/lab/campaign_settings.h"
#include "ext/lab/inspect.h"
#include "ext/lab/noise_by_depth.h"

namespace pbrt {

/// The options of the lightlab command line.
struct LightlabOptions {
    lab::CampaignSettings campaign;   ///< without the samplers
    std::vector<std::string> scenes;  ///< more than one: a campaign on each, in folders of their own
    std::vector<std::string> samplers;
    std::optional<lab::InspectOptions> inspect;  ///< set: `lightlab inspect`
    std::optional<lab::NoiseOptions> noise;      ///< set: `lightlab noise`
    int threads = 0;
    bool quiet = false, report = true;
};

struct LightlabCommandLine {
    LightlabOptions options;
    bool done = false;  ///< help or an error was printed: exit with `status`
    int status = 0;
};

/// `registered`: light samplers of this build, for the default list.
LightlabCommandLine ParseLightlabCommandLine(int argc, const char *const *argv,
                                             const std::vector<std::string> &registered);

/// "x0,y0,x1,y1;..." in pixels of the picture, the second corner excluded. Throws UserError.
std::vector<Bounds2i> ParseCrops(const std::string &text);

}  // namespace pbrt
