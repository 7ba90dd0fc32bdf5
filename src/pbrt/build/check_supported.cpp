#include <algorithm>

#include "pbrt/build/built_scene.h"
#include "pbrt/build/integrator_builder.h"
#include "pbrt/shapes/shape_factory.h"

namespace pbrt {

namespace {

class Checker {
  public:
    explicit Checker(DiagnosticSink &sink) : sink_(sink) {}

    void Type(const char *directive, const Entity &e, const std::vector<std::string> &unsupported, const std::string &advice = "") {
        if (std::find(unsupported.begin(), unsupported.end(), e.type) != unsupported.end())
            NotBuilt(e.loc, fmt::format("{} \"{}\"", directive, e.type), advice);
    }
    void NotBuilt(const FileLoc &loc, const std::string &what, const std::string &advice = "") {
        sink_.Error(loc, what + " is not supported yet." + advice);
    }

  private:
    DiagnosticSink &sink_;
};

}  // namespace

void CheckSupported(const SceneDescription &d, const BuildOptions &options, DiagnosticSink &sink) {
    Checker check(sink);
    if (options.integrator.empty())
        check.Type("Integrator", d.integrator, UnsupportedIntegrators(), " --integrator path renders the scene by path tracing.");
    for (const MediumEntity &m : d.media) check.NotBuilt(m.loc, fmt::format("MakeNamedMedium \"{}\"", m.name));
    auto shape = [&](const ShapeEntity &s) {
        check.Type("Shape", s, UnsupportedShapes());
        if (s.type == "curve" && s.areaLight >= 0)
            sink.Error(s.loc, "Shape \"curve\" cannot be an area light (nor can it in stock pbrt-v4).");
    };
    for (const ShapeEntity &s : d.shapes) shape(s);
    for (const ObjectEntity &o : d.objects)
        for (const ShapeEntity &s : o.shapes) shape(s);
}

}  // namespace pbrt
