#include "pbrt/build/built_scene.h"
#include "pbrt/build/collect.h"
#include "pbrt/shapes/extent.h"

namespace pbrt {
namespace {

/// Rendering space is world space translated to the camera at the middle of the transform times, unless
/// --render-coord-sys overrides it.
Transform RenderFromWorld(const SceneDescription &d, const AnimatedTransform &worldFromCamera,
                          const BuildOptions &options) {
    std::string which =
        !options.renderCoordSys.empty() ? options.renderCoordSys : d.options.renderCoordSys.value_or("cameraworld");
    const Transform middle = worldFromCamera.At((d.camera.startTime + d.camera.endTime) / 2);
    if (which == "camera") return middle.Inverse();
    if (which == "world") return {};
    if (which != "cameraworld")
        throw UserError("rendering coordinate system \"{}\" is unknown; {}.", which,
                        ListChoices(which, {"camera", "cameraworld", "world"}));
    return Transform::Translate(-middle.Point(Point3(0)));
}

}  // namespace

Placement PlaceCamera(const SceneDescription &d, const BuildOptions &options, DiagnosticSink &sink) {
    Placement placement;
    const auto &[start, end] = d.camera.cameraFromWorld;
    Collect(sink, [&] {
        for (const Transform &t : {start, end})
            if (t.IsSingular() || !t.Inverse().IsFinite())
                throw UserError("Camera: the current transformation cannot be inverted, so nothing can be seen.",
                                d.camera.loc);
        Placement p;
        p.worldFromCamera = MotionOf("Camera", d.camera, start.Inverse(), end.Inverse());
        RequireReach("Camera", p.worldFromCamera, Bounds3(Point3(0)), d.camera.loc);
        p.renderFromWorld = RenderFromWorld(d, p.worldFromCamera, options);
        p.renderFromCamera =
            MotionOf("Camera", d.camera, p.renderFromWorld * start.Inverse(), p.renderFromWorld * end.Inverse());
        placement = p;
    });
    return placement;
}

FilmOverrides FilmOverridesOf(const BuildOptions &options) {
    FilmOverrides overrides = options.film;
    if (options.quick) overrides.resolutionDivisor = 4;
    return overrides;
}

RenderView MakeView(SceneDescription &d, const BuildOptions &options, const Placement &placement, int seed,
                    DiagnosticSink &sink) {
    RenderView view;
    Collect(sink, [&] { view.filter = Filters().Make(d.filter.type, d.filter.params, FilterContext{sink}); });
    const Float exposure = ExposureTime(d.camera.params);
    Collect(sink, [&] {
        view.film = MakeFilm(d.film.type, d.film.params,
                             {SpaceOf(d.film), exposure, FilmOverridesOf(options), placement.renderFromCamera,
                              placement.renderFromWorld},
                             sink);
    });
    const Point2i resolution = view.film ? view.film->FullResolution() : Point2i(16, 16);
    const Float diagonal = view.film ? view.film->DiagonalMm() : 35;
    Collect(sink, [&] {  // parameters are validated even if the placement is an error
        const CameraContext context{placement.renderFromCamera, resolution, diagonal, d.files, sink};
        view.camera = Cameras().Make(d.camera.type, d.camera.params, context);
    });
    const int samples = options.quick && options.samplesPerPixel == 0 ? 1 : options.samplesPerPixel;
    Collect(sink, [&] {
        const SamplerContext context{resolution, samples, seed, sink};
        view.sampler = Samplers().Make(d.sampler.type, d.sampler.params, context);
    });
    return view;
}

}  // namespace pbrt
