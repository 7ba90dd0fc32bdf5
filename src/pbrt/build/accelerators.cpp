#include "pbrt/build/accelerators.h"

namespace pbrt {

namespace {

struct BvhParams {
    int maxNodePrims = 4;
    std::string splitMethod = "sah";
    template <class V>
    void Describe(V &&v) {
        v("maxnodeprims", maxNodePrims, "without effect");
        v("splitmethod", splitMethod, "without effect: sah, hlbvh, middle or equal; any other name causes a warning");
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
    template <class V>
    void Describe(V &&v) {
        v("intersectcost", intersectCost, "without effect");
        v("traversalcost", traversalCost, "without effect");
        v("emptybonus", emptyBonus, "without effect");
        v("maxprims", maxPrims, "without effect");
        v("maxdepth", maxDepth, "without effect");
    }
};

}  // namespace

const AcceleratorTable &Accelerators() {
    static const AcceleratorTable table = [] {
        AcceleratorTable t("Accelerator");
        t.Add<BvhParams>("bvh", "checked; without effect", CheckBvh);
        t.Add<KdTreeParams>(
            "kdtree", "checked; without effect",
            [](const auto &, const ParamSet &, const AcceleratorContext &) { return std::monostate(); });
        return t;
    }();
    return table;
}

}  // namespace pbrt
