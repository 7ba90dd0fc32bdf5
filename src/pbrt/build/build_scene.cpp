#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>

#include "pbrt/accel/reach_error.h"
#include "pbrt/build/accelerators.h"
#include "pbrt/build/built_scene.h"
#include "pbrt/build/collect.h"
#include "pbrt/build/geometry_builder.h"
#include "pbrt/build/integrator_builder.h"
#include "pbrt/build/motion.h"
#include "pbrt/core/counters.h"
#include "pbrt/core/files.h"
#include "pbrt/core/parallel.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/math/rng.h"
#include "pbrt/shapes/extent.h"

namespace pbrt {

namespace {

/// Rendering space is world space moved so that the camera sits at the origin halfway between the transform times (or as
/// --render-coord-sys says).
Transform RenderFromWorld(const SceneDescription &d, const AnimatedTransform &worldFromCamera,
                          const BuildOptions &options) {
    std::string which = !options.renderCoordSys.empty() ? options.renderCoordSys : d.options.renderCoordSys.value_or("cameraworld");
    const Transform middle = worldFromCamera.At((d.camera.startTime + d.camera.endTime) / 2);
    if (which == "camera") return middle.Inverse();
    if (which == "world") return {};
    if (which != "cameraworld")
        throw UserError(fmt::format("rendering coordinate system \"{}\" is unknown; {}.", which,
                                    ListChoices(which, {"camera", "cameraworld", "world"})));
    return Transform::Translate(-middle.Point(Point3(0)));
}

/// Where the instance or moving shape stands in whose own coordinates distances grow most.
FileLoc SmallestPlaced(const SceneDescription &d) {
    FileLoc smallest;
    double mostGrowth = -1;
    auto look = [&](const TransformPair &ctm, const FileLoc &loc) {
        for (const Transform *t : {&ctm.start, &ctm.end}) {
            if (t->IsSingular()) continue;  // not placed
            for (int row = 0; row < 3; ++row) {
                double growth = 0;
                for (int c = 0; c < 3; ++c) growth += std::abs(static_cast<double>(t->InverseMatrix()[c][row]));
                if (!(growth > mostGrowth)) continue;
                mostGrowth = growth;
                smallest = loc;
            }
        }
    };
    for (const InstanceEntity &i : d.instances) look(i.ctm, i.loc);
    for (const ShapeEntity &s : d.shapes)
        if (s.ctm.start.Matrix() != s.ctm.end.Matrix()) look(s.ctm, s.loc);
    return smallest;
}

/// "out-more.exr" for "out.exr" and "-more".
std::string WithSuffix(const std::string &name, const char *suffix) {
    const std::filesystem::path path(name);
    return (path.parent_path() / (path.stem().string() + suffix + path.extension().string())).string();
}

/// Throws all errors. The first `checked` diagnostics are of CheckSupported: a later error at one of their places is the
/// factory saying the same again, and is left out.
void ThrowIfErrors(const DiagnosticSink &sink, size_t checked) {
    if (!sink.HasErrors()) return;
    auto place = [](const Diagnostic &d) { return std::tuple(d.loc.file.get(), d.loc.line, d.loc.column); };
    std::set<std::tuple<const SourceFile *, int, int>> known;
    std::vector<Diagnostic> errors;
    for (size_t i = 0; i < sink.All().size(); ++i) {
        const Diagnostic &d = sink.All()[i];
        if (d.severity != Severity::Error) continue;
        if (i < checked) known.insert(place(d));
        if (i < checked || !d.loc || !known.contains(place(d))) errors.push_back(d);
    }
    throw UserError(std::move(errors), sink.Omitted());
}

/// The command line says it, or what it names is missing: no scene can be rendered with it.
bool IsOfCommandLine(const Diagnostic &d) {
    return d.severity == Severity::Error && (!d.loc.file || d.loc.file->name.starts_with("--"));
}

}  // namespace

BuiltScene BuildScene(SceneDescription &d, const BuildOptions &given, const LightSamplerRegistry &registry,
                      DiagnosticSink &sink, Progress &progress) {
    // What is not supported is not built, yet everything else is looked at, so that one run reports all mistakes.
    progress.BeginPhase("building", 0);
    BuiltScene built;
    BuildOptions options = given;
    built.leftOut = CheckSupported(d, options, sink);
    const size_t checked = sink.All().size();

    Transform renderFromWorld;
    const auto &[cameraStart, cameraEnd] = d.camera.cameraFromWorld;
    AnimatedTransform worldFromCamera;
    const bool placed = Collect(sink, [&] {
        for (const Transform &t : {cameraStart, cameraEnd})
            if (t.IsSingular() || !t.Inverse().IsFinite())
                throw UserError("Camera: the current transformation cannot be inverted, so nothing can be seen.",
                                d.camera.loc);
        worldFromCamera = MotionOf("Camera", d.camera, cameraStart.Inverse(), cameraEnd.Inverse());
        RequireReach("Camera", worldFromCamera, Bounds3(Point3(0)), d.camera.loc);
        renderFromWorld = RenderFromWorld(d, worldFromCamera, options);
    });
    built.seed = options.seed.value_or(d.options.seed.value_or(0));

    const SceneOptions &o = d.options;
    built.disablePixelJitter = options.disablePixelJitter || o.disablePixelJitter.value_or(false);
    built.disableWavelengthJitter = options.disableWavelengthJitter || o.disableWavelengthJitter.value_or(false);
    built.mseReferenceImage = !options.mseReferenceImage.empty() ? options.mseReferenceImage : o.mseReferenceImage.value_or("");
    built.mseReferenceOut = !options.mseReferenceOut.empty() ? options.mseReferenceOut : o.mseReferenceOut.value_or("");
    if (built.mseReferenceImage.empty() != built.mseReferenceOut.empty())
        sink.Error({}, "an MSE reference needs both the image and the output file.");

    // Film, camera, filter, sampler: cheap, so their mistakes are found before any geometry is read.
    FilmOverrides film = options.film;
    if (options.quick) film.resolutionDivisor = 4;
    const Float exposure = ExposureTime(d.camera.params);
    Collect(sink, [&] { Accelerators().Make(d.accelerator.type, d.accelerator.params, AcceleratorContext{sink}); });
    const IntegratorSettings integrator = ReadIntegrator(d.integrator, options, registry, sink);
    Collect(sink, [&] {
        built.filter = Filters().Make(d.filter.type, d.filter.params, FilterContext{sink});
    });
    AnimatedTransform renderFromCamera;  // the camera's parameters are looked at wherever it stands
    if (placed)
        Collect(sink, [&] {
            renderFromCamera = MotionOf("Camera", d.camera, renderFromWorld * cameraStart.Inverse(),
                                        renderFromWorld * cameraEnd.Inverse());
        });
    Collect(sink, [&] {
        const FilmContext context{SpaceOf(d.film), exposure, film, renderFromCamera, renderFromWorld};
        built.film = MakeFilm(d.film.type, d.film.params, context, sink);
        built.makeFilm = [params = d.film.params, context] {
            DiagnosticSink ignored;
            FilmContext precise = context;
            precise.overrides.fullFloat = true;
            return MakeFilm("rgb", params, precise, ignored);
        };
    });
    // Without a film (its mistake is told already) the flag's name alone is known.
    built.filename = built.film ? built.film->Filename() : options.film.filename;
    if (!built.leftOut.empty() && !built.filename.empty() && options.film.filename.empty())
        built.filename = WithSuffix(built.filename, options.ignoreUnsupported ? "-incomplete" : "-without-media");
    if (options.checksOutput) {
        if (!built.filename.empty()) Collect(sink, [&] { CheckWritable(built.filename); });
        std::error_code none;
        if (!built.mseReferenceImage.empty() && !std::filesystem::exists(built.mseReferenceImage, none))
            sink.Error({}, fmt::format("{}: the reference image does not exist.", built.mseReferenceImage));
        if (!built.mseReferenceOut.empty()) Collect(sink, [&] { CheckWritable(built.mseReferenceOut); });
    }
    const Point2i resolution = built.film ? built.film->FullResolution() : Point2i(16, 16);
    Collect(sink, [&] {
        const Float diagonal = built.film ? built.film->DiagonalMm() : 35;
        built.camera = Cameras().Make(d.camera.type, d.camera.params,
                                      CameraContext{renderFromCamera, resolution, diagonal, d.files, sink});
        built.cameraFromWorld = worldFromCamera.At(built.camera->ShutterOpen()).Inverse();
    });
    const int spp = options.quick && options.samplesPerPixel == 0 ? 1 : options.samplesPerPixel;
    Collect(sink, [&] {
        std::unique_ptr<Sampler> prototype =
            Samplers().Make(d.sampler.type, d.sampler.params, SamplerContext{resolution, spp, built.seed, sink});
        built.samplesPerPixel = prototype->SamplesPerPixel();
        std::shared_ptr<Sampler> first = std::move(prototype);
        // Later rounds (time budgets only) are fresh samplers with seeds of their own.
        Entity sampler = d.sampler;
        const Param *said = sampler.params.Find("seed", ParamType::Integer);
        const int ownSeed = said ? said->ints.at(0) : built.seed;
        built.makeSeededSampler = [sampler, resolution, spp](int seed, int round) {
            if (round > 0) seed = static_cast<int>(MixBits(static_cast<uint64_t>(seed) * 0x10001 + static_cast<uint64_t>(round)) & 0x7fffffff);
            Entity again = sampler;
            DiagnosticSink ignored;
            Param p;
            p.type = ParamType::Integer;
            p.name = "seed";
            p.ints = {seed};
            again.params.Add(p);
            return Samplers().Make(again.type, again.params, SamplerContext{resolution, spp, 0, ignored});
        };
        built.makeSampler = [first, ownSeed, seeded = built.makeSeededSampler](int round) {
            return round == 0 ? first->Clone() : seeded(ownSeed, round);
        };
    });

    // What is wrong with the scene so far may not be all, so its shapes are looked at, too. But nobody waits for big ones
    // to be told of a flag.
    if (std::any_of(sink.All().begin(), sink.All().end(), IsOfCommandLine)) ThrowIfErrors(sink, checked);

    built.textures = std::make_unique<TextureLibrary>(d.files, sink, options.textureCacheMb);
    for (TextureEntity &t : d.textures)
        Collect(sink, [&] { built.textures->Define(t.name, t.isSpectrum, t.type, t.params, renderFromWorld * t.ctm.start); });

    if (options.forceDiffuse) d.options.forceDiffuse = true;
    if (options.displacementEdgeScale) d.options.displacementEdgeScale = options.displacementEdgeScale;
    GeometryBuilder geometry(d, renderFromWorld, !SeesThroughInterfaces(IntegratorType(d.integrator, options)),
                             *built.textures, sink);
    geometry.BuildMaterials();
    built.textures->CheckAll();

    progress.SetTotal(geometry.ShapeEntityCount());
    geometry.BuildShapes(progress);
    SceneParts parts = geometry.TakeParts();
    built.lightNames = geometry.TakeLightNames();

    for (const LightEntity &l : d.lights)
        Collect(sink, [&] {
            const Transform renderFromLight = renderFromWorld * l.ctm.start;
            parts.lights->Add(Lights().Make(l.type, l.params,
                                            LightContext{renderFromLight, renderFromWorld, SpaceOf(l), d.files, sink}));
            built.lightNames.Add(1, fmt::format("LightSource \"{}\"", l.type), l.loc);
        });
    ThrowIfErrors(sink, checked);
    if (parts.lights->Size() == 0) sink.Warning({}, "the scene has no lights: the image will be black.");

    try {
        parts.accel->Commit();
    } catch (const ReachError &e) {
        throw UserError(e.Diagnostics()[0].message, SmallestPlaced(d));
    }
    Point3 center(0);
    Float radius = 0;
    parts.accel->Bounds().BoundingSphere(&center, &radius);
    parts.lights->Finish(center, radius);
    if (const std::span<const LightId> lights = parts.lights->Overflowed(); !lights.empty())
        sink.Warning({}, fmt::format("The power of {}{} is larger than the largest number, {:.4g}: it counts as 0, so "
                                     "light samplers may leave it out.",
                                     built.lightNames.NameOf(lights[0]),
                                     lights.size() > 1 ? fmt::format(" (and of {} more)", lights.size() - 1) : "",
                                     std::numeric_limits<Float>::max()));
    bool needsFootprints = !options.disableTextureFiltering && !d.options.disableTextureFiltering.value_or(false);
    built.scene = std::make_unique<Scene>(std::move(parts));
    needsFootprints &= built.scene->NeedsFootprints();

    PathContext context{*built.scene, *built.camera, built.samplesPerPixel, needsFootprints};
    const ColorSpace &space = built.film->OutputSpace();
    Collect(sink, [&] {
        BuiltIntegrator made = MakeIntegrator(integrator, context, space, sink);
        built.integrator = std::move(made.integrator);
        built.integratorName = made.name;
        built.lightSamplerName = made.lightSamplerName;
        built.shadowGateName = made.shadowGateName;
        built.maxDepth = made.maxDepth;
    });
    sink.ThrowIfErrors();
    progress.EndPhase();
    built.makeIntegrator = [entity = d.integrator, options, &registry, context, &space](const LightChoice &choice) {
        BuildOptions chosen = options;
        if (!choice.lightSampler.empty()) chosen.lightSampler = choice.lightSampler;
        chosen.meshLights = choice.meshLights;
        if (!choice.shadowGate.empty()) {
            chosen.shadowGate = choice.shadowGate;
            chosen.shadowGateFlag = options.lightSamplerFlag;  // said together with the sampler
        }
        if (choice.maxDepth) chosen.maxDepth = choice.maxDepth;
        DiagnosticSink again;  // its warnings were given before
        const IntegratorSettings settings = ReadIntegrator(entity, chosen, registry, again);
        again.ThrowIfErrors();
        return MakeIntegrator(settings, context, space, again);
    };
    return built;
}

}  // namespace pbrt
