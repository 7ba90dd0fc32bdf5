#include <algorithm>
#include <set>
#include <tuple>

#include "pbrt/accel/accel.h"
#include "pbrt/build/built_scene.h"
#include "pbrt/build/collect.h"
#include "pbrt/build/geometry_builder.h"
#include "pbrt/build/integrator_builder.h"
#include "pbrt/core/files.h"
#include "pbrt/images/image.h"
#include "pbrt/lights/light_factory.h"
#include "pbrt/shapes/extent.h"

namespace pbrt {
namespace {

/// Rendering space: by default world space translated to the camera. `middle`: world from camera at the middle of the
/// transform times.
Transform RenderFromWorld(const SceneDescription &d, const Transform &middle, const BuildOptions &options) {
    std::string which =
        !options.renderCoordSys.empty() ? options.renderCoordSys : d.options.renderCoordSys.value_or("cameraworld");
    if (which == "world") return {};
    const Transform toCamera = Transform::Translate(-middle.Point(Point3(0)));
    // Without the camera's scale and mirroring, which would change distances and the sides of surfaces.
    const auto axis = [&](int i) { return Vector3(glm::normalize(glm::dvec3(middle.Matrix()[i]))); };
    if (which == "camera")
        return Product({Transform::LookAt(Point3(0), axis(2), axis(1)).value_or(Transform()), toCamera});
    if (which != "cameraworld")
        throw UserError("rendering coordinate system \"{}\" is unknown; {}.", which,
                        ListChoices(which, {"camera", "cameraworld", "world"}));
    return toCamera;
}

/// Location of the instance or moving shape whose inverse transformation has the largest scale.
FileLoc SmallestPlaced(const SceneDescription &d) {
    FileLoc smallest;
    double maxGrowth = -1;
    auto compare = [&](const TransformPair &ctm, const FileLoc &loc) {
        for (const Transform *t : {&ctm.start, &ctm.end}) {
            if (t->IsSingular()) continue;  // hidden
            for (int row = 0; row < 3; ++row) {
                double growth = 0;
                for (int c = 0; c < 3; ++c) growth += std::abs(double(t->InverseMatrix()[c][row]));
                if (!(growth > maxGrowth)) continue;
                maxGrowth = growth;
                smallest = loc;
            }
        }
    };
    for (const InstanceEntity &i : d.instances) compare(i.ctm, i.loc);
    for (const ShapeEntity &s : d.shapes)
        if (s.ctm.start.Matrix() != s.ctm.end.Matrix()) compare(s.ctm, s.loc);
    return smallest;
}

/// Throws all errors. The first `checked` diagnostics are from CheckSupported; later errors at the same locations are
/// duplicates and omitted.
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

/// True for errors in the command line or in a file it names, which no scene can fix.
bool IsOfCommandLine(const Diagnostic &d) {
    return d.severity == Severity::Error && (!d.loc.file || d.loc.file->name.starts_with("--"));
}

void ChooseRenderOptions(const SceneOptions &scene, const BuildOptions &options, BuiltScene &built,
                         DiagnosticSink &sink) {
    auto name = [](const std::string &flag, const std::optional<std::string> &o) {
        return !flag.empty() ? flag : o.value_or("");
    };
    built.seed = options.seed.value_or(scene.seed.value_or(0));
    built.disablePixelJitter = options.disablePixelJitter || scene.disablePixelJitter.value_or(false);
    built.disableWavelengthJitter = options.disableWavelengthJitter || scene.disableWavelengthJitter.value_or(false);
    built.mseReferenceImage = name(options.mseReferenceImage, scene.mseReferenceImage);
    built.mseReferenceOut = name(options.mseReferenceOut, scene.mseReferenceOut);
    if (built.mseReferenceImage.empty() != built.mseReferenceOut.empty())
        sink.Error(scene.mseReferenceLoc, "an MSE reference needs both the image and the output file.");
}

/// Output file name. Without a valid film only the flag's name is available.
std::string OutputName(const BuiltScene &built, const BuildOptions &options) {
    const std::string name = built.film ? built.film->Filename() : options.film.filename;
    if (built.leftOut.empty() || name.empty() || !options.film.filename.empty()) return name;
    return WithSuffix(name, options.ignoreUnsupported ? "-incomplete" : "-without-media");
}

/// Adds errors for outputs that would replace another output or an input. With BuildOptions::checksOutput, also for the
/// image, for outputs that are not writable, and for a missing reference image.
void CheckOutput(const BuiltScene &built, const SceneDescription &d, const BuildOptions &options,
                 DiagnosticSink &sink) {
    const auto named = [](const char *flag, const std::string &given, const char *directive, const std::string &path,
                          const FileLoc &loc) {
        return given.empty() ? NamedFile{directive, path, loc} : NamedFile{flag, path};
    };
    const FileLoc &mseLoc = d.options.mseReferenceLoc;
    std::vector<NamedFile> outputs, inputs = options.inputs;
    if (options.checksOutput && !built.filename.empty())
        outputs.push_back(
            named("--outfile", options.film.filename, "Film", built.filename, d.film.params.LocOf("filename")));
    if (!built.mseReferenceOut.empty())
        outputs.push_back(named("--mse-reference-out", options.mseReferenceOut, "Option \"msereferenceout\"",
                                built.mseReferenceOut, mseLoc));
    for (const NamedFile &o : outputs) try {
            if (options.checksOutput) CheckWritable(o.path);
        } catch (const UserError &e) {
            sink.Error(o.loc, e.Diagnostics()[0].message);
        }
    outputs.insert(outputs.end(), options.outputs.begin(), options.outputs.end());

    if (!built.mseReferenceImage.empty()) {
        inputs.push_back(named("--mse-reference-image", options.mseReferenceImage, "Option \"msereferenceimage\"",
                               built.mseReferenceImage, mseLoc));
        if (options.checksOutput && !FileExists(built.mseReferenceImage))
            sink.Error(inputs.back().loc, "{}: the reference image does not exist.", built.mseReferenceImage);
    }
    for (const std::string &source : d.sources) inputs.push_back({"the scene", source});
    const auto addAssets = [&](const Entity &entity) {
        for (const Param &p : entity.params.Own())
            for (const std::string &name : p.strings)
                if (p.type != ParamType::Texture)
                    inputs.push_back({entity.params.What(), d.files.Resolve(name), p.loc});
    };
    const auto addAllAssets = [&](const auto &...lists) { (std::ranges::for_each(lists, addAssets), ...); };
    if (std::ranges::any_of(outputs, FileExists, &NamedFile::path)) {
        addAssets(d.camera);
        ForEachShape(d, addAssets);
        addAllAssets(d.materials, d.textures, d.media, d.lights, d.areaLights);
    }
    for (const NamedFile &output : outputs) {
        for (const NamedFile &other : inputs)
            if (IsSameFile(output.path, other.path))
                sink.Error(output.loc ? output.loc : other.loc,
                           "{}: is named by {} and by {}, so one would overwrite the other.", output.path, output.owner,
                           other.owner);
        inputs.push_back(output);
    }
}

std::unique_ptr<TextureLibrary> MakeTextures(SceneDescription &d, const BuildOptions &options,
                                             const Transform &renderFromWorld, DiagnosticSink &sink) {
    auto textures = std::make_unique<TextureLibrary>(d.files, sink, options.textureCacheMb);
    for (TextureEntity &t : d.textures)
        Collect(sink, [&] { textures->Define(t.name, t.isSpectrum, t.type, t.params, renderFromWorld * t.ctm.start); });
    return textures;
}

/// Creates media, materials, shapes and lights; not ready for rays yet.
SceneContents MakeContents(SceneDescription &d, const BuildOptions &options, const Placement &placement,
                           TextureLibrary &textures, LightNames &lightNames, Bounds3 &receivers, DiagnosticSink &sink,
                           Progress &progress) {
    const Transform &renderFromWorld = placement.renderFromWorld;
    BuiltMedia media = MakeMedia(d, renderFromWorld, sink);
    if (const std::string &type = IntegratorType(d.integrator, options);
        !media.media.empty() && !TraitsOf(type).rendersMedia) {
        sink.Warning({}, "integrator \"{}\" renders no media; \"volpath\" does.", type);
        media = {};
    }
    GeometryBuilder geometry(d, renderFromWorld, placement.eye,
                             !TraitsOf(IntegratorType(d.integrator, options)).passesInterfaces, media, textures, sink);
    geometry.BuildMaterials();
    textures.CheckAll();
    progress.SetTotal(geometry.ShapeEntityCount());
    geometry.BuildShapes(progress);
    SceneContents contents = geometry.TakeContents();
    lightNames = geometry.TakeLightNames();
    receivers = geometry.Receivers();
    for (const LightEntity &l : d.lights)
        Collect(sink, [&] {
            const Transform renderFromLight = renderFromWorld * l.ctm.start;
            auto light = Lights().Make(l.type, l.params,
                                       LightContext{renderFromLight, renderFromWorld, SpaceOf(l), d.files, sink});
            // Light from outside the scene arrives through vacuum, regardless of the current medium at its LightSource.
            const bool isBeyondScene =
                light->Kind() == LightKind::Infinite || light->Kind() == LightKind::DeltaDirection;
            const MediumId medium = isBeyondScene ? MediumId() : media.Find(l.medium);
            contents.lights->Add(std::move(light));
            contents.lightMedia.push_back({medium, medium});
            lightNames.Add(1, fmt::format("LightSource \"{}\"", l.type), l.loc);
        });
    contents.worldOrigin = renderFromWorld.Point(Point3(0));
    contents.cameraMedium = media.Find(d.camera.medium);
    contents.media = std::move(media.media);
    return contents;
}

/// Creates the scene, ready for rays, from valid contents.
std::unique_ptr<Scene> MakeScene(SceneContents contents, const Bounds3 &receivers, const SceneDescription &d,
                                 DiagnosticSink &sink) {
    if (contents.lights->Size() == 0) sink.Warning({}, "the scene has no lights: the image will be black.");
    try {
        contents.accel->Commit();
    } catch (const ReachError &e) {
        throw UserError(e.Diagnostics()[0].message, SmallestPlaced(d));
    }
    Point3 center(0);
    Float radius = 0;
    contents.accel->Bounds().BoundingSphere(&center, &radius);
    contents.lights->Finish(center, radius, receivers);
    return std::make_unique<Scene>(std::move(contents));
}

BuiltIntegrator MakeIntegrator(const BuiltScene &built, const Entity &entity, const BuildOptions &options) {
    DiagnosticSink sink;  // its warnings were reported when the scene was built
    const IntegratorSettings settings = ReadIntegrator(entity, options, *built.integratorRequest.registry, sink);
    sink.ThrowIfErrors();
    return MakeIntegrator(built, settings, sink);
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
        const Transform middle = p.worldFromCamera.At((d.camera.startTime + d.camera.endTime) / 2);
        p.eye = middle.Point(Point3(0));
        p.renderFromWorld = RenderFromWorld(d, middle, options);
        p.renderFromCamera =
            MotionOf("Camera", d.camera, p.renderFromWorld * start.Inverse(), p.renderFromWorld * end.Inverse());
        placement = p;
    });
    return placement;
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

void BuiltScene::SetSamples(int samples) {
    DiagnosticSink sink;
    IntegratorRequest &request = integratorRequest;
    request.options.samplesPerPixel = samples;
    const SamplerContext context{film->FullResolution(), samples, seed, sink};
    sampler = Samplers().Make(request.sampler.type, request.sampler.params, context);
    samplesPerPixel = sampler->SamplesPerPixel();
    integrator = MakeIntegrator(*this, request.entity, request.options).integrator;
}

BuiltScene BuildScene(SceneDescription &d, const BuildOptions &given, const PluginRegistry &registry,
                      DiagnosticSink &sink, Progress &progress) {
    // Unsupported features are not built, but everything else is checked, so that one run reports all errors.
    BuiltScene built;
    BuildOptions options = given;
    built.leftOut = CheckSupported(d, options, sink);
    const size_t checked = sink.All().size();
    CheckUnbuilt(d, registry, sink);

    const Placement placement = PlaceCamera(d, options, sink);
    ChooseRenderOptions(d.options, options, built, sink);
    Collect(sink, [&] { Accelerators().Make(d.accelerator.type, d.accelerator.params, AcceleratorContext{sink}); });
    const IntegratorSettings integrator = ReadIntegrator(d.integrator, options, registry, sink);
    if (built.disablePixelJitter && !options.disablePixelJitter && !TraitsOf(integrator.type).samplesPixels)
        sink.Warning({}, "integrator \"{}\" has no samples of single pixels, so pixel jitter cannot be disabled.",
                     integrator.type);
    if (integrator.samplesPerPixel > 0 && options.samplesPerPixel == 0 && !options.quick)
        options.samplesPerPixel = integrator.samplesPerPixel;
    static_cast<RenderView &>(built) = MakeView(d, options, placement, built.seed, sink);
    if (built.sampler) built.samplesPerPixel = built.sampler->SamplesPerPixel();
    if (integrator.adaptive && built.film) built.half = built.film->MakeRgbFilm();
    if (built.camera) built.cameraFromWorld = placement.worldFromCamera.At(built.camera->ShutterOpen()).Inverse();
    built.filename = OutputName(built, options);
    const size_t errorsBefore = sink.ErrorCount();
    CheckOutput(built, d, options, sink);
    // Shapes are checked even after errors, to report all; those of files and of the command line come before large
    // shapes are read.
    if (sink.ErrorCount() > errorsBefore || std::any_of(sink.All().begin(), sink.All().end(), IsOfCommandLine))
        ThrowIfErrors(sink, checked);

    const double filmBytes =
        (built.film ? double(built.film->Bytes()) : 0) + (built.half ? double(built.half->Bytes()) : 0);
    built.memory = EstimateMemory(d, filmBytes, options.textureCacheMb <= 0);
    Collect(sink, [&] { RequireMemory(built.memory); });
    if (std::any_of(sink.All().begin(), sink.All().end(), IsOfCommandLine)) ThrowIfErrors(sink, checked);

    if (options.forceDiffuse) d.options.forceDiffuse = true;
    if (options.displacementEdgeScale) d.options.displacementEdgeScale = options.displacementEdgeScale;
    built.textures = MakeTextures(d, options, placement.renderFromWorld, sink);
    Bounds3 receivers;
    SceneContents contents =
        MakeContents(d, options, placement, *built.textures, built.lightNames, receivers, sink, progress);
    ThrowIfErrors(sink, checked);
    built.scene = MakeScene(std::move(contents), receivers, d, sink);

    const bool filters = !options.disableTextureFiltering && !d.options.disableTextureFiltering.value_or(false);
    built.integratorRequest = {d.integrator, d.sampler, options, &registry, filters && built.scene->NeedsFootprints()};
    Collect(sink, [&] { static_cast<BuiltIntegrator &>(built) = MakeIntegrator(built, integrator, sink); });
    sink.ThrowIfErrors();
    return built;
}

BuiltIntegrator MakeIntegrator(const BuiltScene &built, const LightChoice &choice) {
    const auto &[entity, pixelSampler, options, registry, needsFootprints] = built.integratorRequest;
    BuildOptions chosen = options;
    if (!choice.lightSampler.empty()) chosen.lightSampler = choice.lightSampler;
    chosen.meshLights = choice.meshLights;
    if (choice.maxDepth) chosen.maxDepth = choice.maxDepth;
    return MakeIntegrator(built, entity, chosen);
}

std::unique_ptr<Integrator> MakePlainIntegrator(const BuiltScene &built) {
    const IntegratorRequest &request = built.integratorRequest;
    BuildOptions plain = request.options;
    plain.lightSampler = "bvh";
    plain.meshLights = plain.guide = false;
    if (!built.shootingSamplerName.empty()) plain.shootingSampler = "power";
    Entity entity = request.entity;
    entity.params = ParamSet(request.entity.params.What(), request.entity.loc);
    for (const Param &p : request.entity.params.Own())
        if (p.name != "guide") entity.params.Add(p);
    return MakeIntegrator(built, entity, plain).integrator;
}

}  // namespace pbrt
