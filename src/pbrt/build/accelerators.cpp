#include "pbrt/build/integrator_builder.h"

namespace pbrt {
namespace {

struct BvhParams {
    int maxNodePrims = 4;
    std::string splitMethod = "sah";
    void Describe(auto &&v) {
        v("maxnodeprims", maxNodePrims, "no effect");
        v("splitmethod", splitMethod, "no effect: sah, hlbvh, middle or equal, else a warning");
    }
};

std::monostate CheckBvh(const BvhParams &p, const ParamSet &set, const AcceleratorContext &context) {
    const std::vector<std::string> methods = {"sah", "hlbvh", "middle", "equal"};
    if (std::find(methods.begin(), methods.end(), p.splitMethod) == methods.end())
        set.Warn(
            context.sink, "splitmethod",
            fmt::format("split method \"{}\" is unknown; {}.", p.splitMethod, ListChoices(p.splitMethod, methods)));
    return {};
}

struct KdTreeParams {
    int intersectCost = 5, traversalCost = 1, maxPrims = 1, maxDepth = -1;
    Float emptyBonus = 0.5f;
    void Describe(auto &&v) {
        v("intersectcost", intersectCost, "no effect");
        v("traversalcost", traversalCost, "no effect");
        v("emptybonus", emptyBonus, "no effect");
        v("maxprims", maxPrims, "no effect");
        v("maxdepth", maxDepth, "no effect");
    }
};

}  // namespace

const AcceleratorTable &Accelerators() {
    static const AcceleratorTable table("Accelerator", [](AcceleratorTable &t) {
        t.Add<BvhParams>("bvh", "checked; without effect", CheckBvh);
        t.Add<KdTreeParams>(
            "kdtree", "checked; without effect",
            [](const auto &, const ParamSet &, const AcceleratorContext &) { return std::monostate(); });
    });
    return table;
}

}  // namespace pbrt
