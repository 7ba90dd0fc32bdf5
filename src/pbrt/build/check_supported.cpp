#include "pbrt/build/integrator_builder.h"
#include "pbrt/textures/texture_factory.h"

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

void LeaveOutMedia(SceneDescription &d) {
    d.media.clear();
    d.camera.medium.clear();
    for (LightEntity &light : d.lights) light.medium.clear();
    ForEachShape(d, [](ShapeEntity &s) {
        s.insideMedium.clear();
        s.outsideMedium.clear();
    });
}

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

std::vector<std::string> CheckSupported(SceneDescription &d, BuildOptions &options, DiagnosticSink &sink) {
    std::vector<std::string> leftOut;
    auto leaveOut = [&](const FileLoc &loc, const std::string &what, const std::string &replacement = "") {
        const std::string instead = replacement.empty() ? "" : ", " + replacement + " is used instead";
        const std::string left = what + " is left out" + instead;
        sink.Warning(loc, left + ": the image is not that of the scene.");
        leftOut.push_back(loc ? fmt::format("{}:{}: {}", loc.file->name, loc.line, left) : left);
    };
    if (options.ignoreMedia) {
        for (const MediumEntity &m : d.media) leaveOut(m.loc, fmt::format("MakeNamedMedium \"{}\"", m.name));
        LeaveOutMedia(d);
    }
    if (options.integrator.empty() && d.integrator.type == kUnsupportedIntegrator) {
        const std::string what = fmt::format("Integrator \"{}\"", kUnsupportedIntegrator);
        const std::string instead = d.media.empty() ? "path" : "volpath";
        if (options.ignoreUnsupported) {
            leaveOut(d.integrator.loc, what, instead);
            options.integrator = instead;
        } else {
            sink.Error(d.integrator.loc, "{} is not supported yet. --integrator {} renders the scene by path tracing.",
                       what, instead);
        }
    }
    for (TextureEntity &t : d.textures) {
        // Without the flag, the texture's own error is more detailed.
        if (!options.ignoreUnsupported || t.type != kUnsupportedTexture) continue;
        leaveOut(t.loc, fmt::format("Texture \"{}\" of class {}", t.name, t.type), "a constant 0.5");
        Param half;
        half.name = "value";
        half.type = t.isSpectrum ? ParamType::Rgb : ParamType::Float;
        half.floats.assign(t.isSpectrum ? 3 : 1, 0.5f);
        t.type = "constant";
        t.params = ParamSet("Texture \"constant\"", t.loc);
        t.params.Add(std::move(half));
    }
    ForEachShape(d, [&](const ShapeEntity &s) {
        if (s.type == "curve" && s.areaLight >= 0)
            sink.Error(s.loc, "Shape \"curve\" cannot be an area light (nor can it in stock pbrt-v4).");
    });
    return leftOut;
}

}  // namespace pbrt
