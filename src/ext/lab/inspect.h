#pragma once
#include <functional>
#include <string>
#include <vector>

#include "ext/lab/text_output.h"
#include "pbrt/build/built_scene.h"
#include "pbrt/images/image.h"

namespace ext::lab {
using namespace pbrt;

/// The effort of an inspection.
struct InspectSettings {
    int samples = 32;      ///< light samples (and shadow rays) per light and pixel
    int shownLights = 16;  ///< images of measured visibility, for the lights of most power
    /// Bound on pixels x (lights + groups x samples). Beyond it only every n-th pixel of a row and column is inspected,
    /// and stands for its neighbours.
    double maxWork = 5e8;
};

/// One picture: a channel of Inspection::image.
struct InspectedLayer {
    std::string name, meaning;
    bool isId = false;                     ///< values are identifiers, shown as colours without order
    bool ofScene = false;                  ///< the same for every sampler
    double shownLeast = 0, shownMost = 1;  ///< ends of the colour scale
    double least = 0, most = 0, mean = 0;  ///< of the finite values where "hit" is 1 (layer "hit": everywhere)
    size_t values = 0, unknown = 0;        ///< number of these finite values, and of those that are not finite
    std::string light;                     ///< name of the light that the layer is about; empty: no single light
    /// Returns true if the value is the same everywhere, or nowhere defined; the page then has a sentence, no picture.
    bool IsFlat() const { return values == 0 || (least == most && unknown == 0); }
};

/// What counts as one light: a light, or all primitives of an emissive mesh.
struct InspectedLight {
    LightId first{};
    size_t count = 1;  ///< lights of the table, contiguous
    double power = 0;
    std::string label;  ///< its place in the scene file, from LightNames
};

struct Inspection {
    /// One float channel per layer, over the film's pixels. Layer "hit" is 1 where a surface that is not purely
    /// specular is visible, directly or through specular ones; all others are 0 elsewhere.
    Image image;
    std::vector<InspectedLayer> layers;  ///< "hit" first
    std::vector<InspectedLight> lights;
    std::string structure;  ///< LightSampler::DescribeStructure
    int stride = 1;         ///< see InspectSettings::maxWork
};

/// Inspects the integrator's light sampler, which is prepared, at the first visible surfaces, with one ray
/// per pixel through its centre. Every call gives the same values. Layers: every value of LightSampler::Inspect;
/// entropy of the pmf over lights; the light that contributes most, and its probability; second moment of the one-light
/// estimator over the least possible one; measured visibility of the strongest lights; mean number of vertices of some
/// paths, and the state of the path guide.
Inspection InspectLights(const BuiltScene &built, const Integrator &integrator, const InspectSettings &settings,
                         Progress &progress);
/// The same of a light sampler alone.
Inspection InspectLights(const BuiltScene &built, const LightSampler &sampler, const InspectSettings &settings,
                         Progress &progress);

/// Writes one false-colour PNG per layer that is `wanted` and not flat into `folder`, which is created if needed;
/// `legendRows`: height in pixels of the colour bar below. Returns for every wanted layer: name, file (inside `folder`;
/// null if flat), meaning, ends of the colour scale, range.
Json WriteLayers(const Inspection &inspection, const std::string &folder, int legendRows,
                 const std::function<bool(const InspectedLayer &)> &wanted);

/// Writes inspect.exr (all layers), one false-colour PNG per layer that is not flat, inspect.json (what each shows and
/// its range), index.html (a page that shows all of this) and structure.txt into `folder`, which is created if needed.
void WriteInspection(const Inspection &inspection, const std::string &folder, const Json &about);

/// The options of `lightlab inspect scene.pbrt --sampler octree`.
struct InspectOptions {
    std::vector<std::string> sceneFiles;
    BuildOptions build;  ///< build.lightSampler: the inspected sampler; film overrides set the resolution
    InspectSettings settings;
    std::string outFolder;  ///< empty: "inspect-<sampler>" in the working folder
    std::string commandLine;
};

/// Reads and builds the scene, prepares and inspects the sampler, writes the results, and prints the structure and the
/// ranges to standard output. Exit status: 0, or 130 if interrupted. Throws UserError.
int RunInspect(const InspectOptions &options, const PluginRegistry &registry, Progress &progress);

/// The HTML page for the pictures in the same folder, made from the contents of inspect.json: pictures with captions,
/// sentences about layers that are the same everywhere, the lights, the structure.
std::string InspectPage(const Json &inspection, const std::string &structure);

}  // namespace ext::lab
