#include "ext/guiding/path_guide.h"
#include "pbrt/integrators/registry.h"

void register_guide(pbrt::PluginRegistry &registry) {
    using namespace ext;
    registry.directionSamplings.Add<GuideParams>(
        "guide", "path guiding and learned Russian roulette, from records of the render; written octree+guide",
        [](GuideParams p, const ParamSet &, const DirectionRequest &request) -> std::unique_ptr<DirectionSampling> {
            if (!request.isGuided && !p.roulette) return nullptr;
            p.directions &= request.isGuided;
            return std::make_unique<PathGuide>(p);
        });
}
