#include "scene_fixtures.h"

#include <fmt/format.h>

#include <map>

#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/transport/vertex.h"
#include "support/scene_text.h"

namespace pbrt::test {

namespace {

constexpr const char *kAssets = PBRT_SOURCE_DIR "/tests/conformance/suite/scenes/assets";

template <class V>
std::string At(const V &v) {
    return fmt::format(" {} {} {} ", v.x, v.y, v.z);
}

/// Collects a scene's text; all lengths are in units of `scale`.
class Text {
  public:
    explicit Text(double scale = 1) : scale_(scale) {}

    Text &Add(const std::string &line) {
        world_.Add(line);
        return *this;
    }
    /// In an attribute block, after the directives `before`.
    Text &Place(const std::string &before, const Objects &objects) {
        world_.Attribute(before, objects);
        return *this;
    }
    Text &Quad(const Point3 &p, const Vector3 &a, const Vector3 &b, const std::string &before = "") {
        return Place(before, Objects().Quad(At(p) + At(p + a) + At(p + b) + At(p + a + b)));
    }
    /// Two rooms side by side, open to the camera, a door between them.
    Text &Rooms() {
        Add("Material 'diffuse' 'rgb reflectance' [ 0.6 0.5 0.4 ]");
        Quad({-3, 0, -3}, {6, 0, 0}, {0, 0, 6}).Quad({-3, 2.5f, -3}, {6, 0, 0}, {0, 0, 6});
        Quad({-3, 0, 3}, {6, 0, 0}, {0, 2.5f, 0});
        Quad({-3, 0, -3}, {0, 0, 6}, {0, 2.5f, 0}).Quad({3, 0, -3}, {0, 0, 6}, {0, 2.5f, 0});
        Quad({0, 0, -2}, {0, 0, 2.5f}, {0, 2.5f, 0}).Quad({0, 0, 1}, {0, 0, 2}, {0, 2.5f, 0});
        Sphere({-1.2f, 0.5f, 0.5f}, 0.5f);
        return Sphere({1.2f, 0.4f, 0.3f}, 0.4f, "Material 'dielectric' 'float roughness' 0.3");
    }
    /// A room that is closed but for two windows in its back; the camera is inside.
    Text &ClosedRoom() {
        Add("Material 'diffuse' 'rgb reflectance' [ 0.6 0.5 0.4 ]");
        Quad({-3, 0, -5}, {6, 0, 0}, {0, 0, 8}).Quad({-3, 2.5f, -5}, {6, 0, 0}, {0, 0, 8});
        Quad({-3, 0, -5}, {6, 0, 0}, {0, 2.5f, 0});
        Quad({-3, 0, -5}, {0, 0, 8}, {0, 2.5f, 0}).Quad({3, 0, -5}, {0, 0, 8}, {0, 2.5f, 0});
        // The back wall, around the windows.
        Quad({-3, 0, 3}, {6, 0, 0}, {0, 0.8f, 0}).Quad({-3, 2, 3}, {6, 0, 0}, {0, 0.5f, 0});
        Quad({-3, 0.8f, 3}, {1.4f, 0, 0}, {0, 1.2f, 0}).Quad({-0.4f, 0.8f, 3}, {0.8f, 0, 0}, {0, 1.2f, 0});
        Quad({1.6f, 0.8f, 3}, {1.4f, 0, 0}, {0, 1.2f, 0});
        Sphere({-1.2f, 0.5f, 0.5f}, 0.5f);
        return Sphere({1.2f, 0.4f, 0.3f}, 0.4f, "Material 'coateddiffuse' 'float roughness' 0.1");
    }
    Text &Sphere(const Point3 &p, Float radius, const std::string &before = "") {
        return Place(before + "\nTranslate" + At(p), Objects().Sphere(double(radius)));
    }
    /// Intensities grow with the square of lengths, so that a scaled scene looks the same.
    Text &PointLight(const Point3 &p, double intensity) {
        return Add("LightSource 'point' 'point3 from' [" + At(p) + "] 'rgb I' [" +
                   At(intensity * scale_ * scale_ * glm::dvec3(1, 0.8, 0.5)) + "]");
    }
    Text &SpotLight(const Point3 &p, const Point3 &to, double cone, double intensity) {
        return Add(
            fmt::format("LightSource 'spot' 'point3 from' [{}] 'point3 to' [{}] 'float coneangle' {} "
                        "'float conedeltaangle' {} 'rgb I' [{}]",
                        At(p), At(to), cone, cone / 4, At(intensity * scale_ * scale_ * glm::dvec3(1, 1, 0.6))));
    }
    Text &Sky(double radiance) { return Add(fmt::format("LightSource 'infinite' 'rgb L' [ {0} {0} {0} ]", radiance)); }
    Text &Sun(const Vector3 &from, double irradiance) {
        return Add(fmt::format("LightSource 'distant' 'point3 from' [{}] 'point3 to' [ 0 0 0 ] 'rgb L' [ {} {} 0 ]",
                               At(from), irradiance, irradiance));
    }
    /// A light with an image, at a place; the statements `before` rotate it.
    Text &ImageLight(const std::string &type, const std::string &asset, const Point3 &p, const std::string &before,
                     double scale) {
        return Place(
            "Translate" + At(p) + "\n" + before,
            Objects().Light(type, fmt::format("'string filename' '{}/{}' 'float scale' {}", kAssets, asset, scale)));
    }
    /// The sky through the rectangle p, p + a, p + a + b, p + b; it shines against cross(b, a). Given in world space.
    Text &Portal(const Point3 &p, const Vector3 &a, const Vector3 &b, double radiance) {
        return Add(
            fmt::format("LightSource 'infinite' 'string filename' '{}/env_sky.exr' 'float scale' {} "
                        "'point3 portal' [{}]",
                        kAssets, radiance, At(p) + At(p + a) + At(p + a + b) + At(p + b)));
    }
    /// A bulb of 2 * rings * segments triangles.
    Text &Bulb(const Point3 &center, double radius, int rings, int segments, double radiance) {
        std::string points, indices;
        for (int i = 0; i <= rings; ++i)
            for (int j = 0; j < segments; ++j) {
                double theta = 3.14159265 * (i + 0.5) / (rings + 1), phi = 2 * 3.14159265 * j / segments;
                double r = radius * (1 + 0.1 * std::sin(5 * phi) * std::sin(7 * theta));
                points += At(glm::dvec3(center) + r * glm::dvec3(std::sin(theta) * std::cos(phi),
                                                                 std::sin(theta) * std::sin(phi), std::cos(theta)));
            }
        for (int i = 0; i < rings; ++i)
            for (int j = 0; j < segments; ++j) {
                int a = i * segments + j, b = a + segments, c = i * segments + (j + 1) % segments, d = c + segments;
                indices += fmt::format("{} {} {} {} {} {} ", a, b, c, b, d, c);
            }
        return Place(Area(radiance), Objects().Triangles(points, indices));
    }
    static std::string Area(double radiance, bool twoSided = false) {
        return fmt::format("AreaLightSource 'diffuse' 'rgb L' [ {0} {0} {0} ] 'bool twosided' {1}", radiance, twoSided);
    }

    std::string Finish() const {
        return SceneText()
            .LookAt(fmt::format("0 {} {}  0 {} 0  0 1 0", 1.3 * scale_, -4.5 * scale_, 1.0 * scale_))
            .Camera(55)
            .Film(48, 36)
            .Samples(4)
            .Integrator("path")
            .World(fmt::format("Scale {0} {0} {0}\n", scale_) + std::string(world_));
    }

  private:
    Objects world_;
    double scale_;
};

std::string Mixed(double scale) {
    Text t(scale);
    t.Rooms().Sky(0.2).Sun({1, 2, -4}, 0.5);
    Rng rng(7);
    for (int i = 0; i < 5; ++i) {
        auto place = [&] {
            return Point3(5.6f * rng.Uniform() - 2.8f, 2.3f * rng.Uniform() + 0.1f, 5 * rng.Uniform() - 2.2f);
        };
        t.PointLight(place(), 0.3 + i);
        Point3 from = place();
        t.SpotLight(from, from + Vector3(rng.Uniform() - 0.5f, -1, rng.Uniform() - 0.5f), 10 + 15 * i, 2);
        t.Quad(place(), {0.3f, 0, 0}, {0, 0.1f, 0.3f}, Text::Area(2 + i, i % 2 == 0));
        t.Sphere(place(), 0.05f + 0.02f * Float(i), Text::Area(3));
    }
    t.Bulb({1.8f, 1.6f, 2}, 0.15, 5, 6, 8);
    t.Bulb({-1.8f, 1.6f, 2}, 0.1, 3, 4, 2);
    return t.Finish();
}

/// Lamps that emit in a few nanometres beside one of all wavelengths, on all kinds of lights.
std::string NarrowBands() {
    const auto line = [](const char *name, int nm, double scale) {
        return fmt::format("'spectrum {}' [ {} 0 {} 1 {} 0 ] 'float scale' {}", name, nm - 2, nm, nm + 2, scale);
    };
    Text t;
    t.Rooms().PointLight({-1, 2, 1}, 1).ImageLight("infinite", "env_sky.exr", {0, 0, 0}, "", 0.1);
    t.Add("LightSource 'point' 'point3 from' [ 1 2 1 ] " + line("I", 589, 1));
    t.Add("LightSource 'spot' 'point3 from' [ -2 2 -1 ] 'point3 to' [ -2 0 0 ] " + line("I", 520, 2));
    t.Add("LightSource 'distant' 'point3 from' [ 1 2 -4 ] " + line("L", 650, 0.5));
    t.Quad({1, 2.4f, 1}, {1, 0, 0}, {0, 0, 1}, "AreaLightSource 'diffuse' " + line("L", 450, 2));
    t.Sphere({-2, 1.5f, 1}, 0.1f, "AreaLightSource 'diffuse' " + line("L", 700, 3));
    t.Quad({-2.9f, 1, 0}, {0, 0.2f, 0}, {0, 0, 0.2f}, "AreaLightSource 'diffuse' " + line("L", 405, 3));
    return t.Finish();
}

/// Emission and alpha that vary over the surface, lights that rays do not see, and every shape that emits.
std::string AreaLights() {
    const std::string file = fmt::format("'{}/panel.png'", kAssets);
    const std::string image = "AreaLightSource 'diffuse' 'float scale' 3 'string filename' " + file;
    const Vector3 right(0.8f, 0, 0), back(0, 0, 0.8f);
    return Text()
        .Rooms()
        .Add("Texture 'holes' 'float' 'checkerboard' 'float uscale' 3 'float vscale' 3")
        .Quad({-2.5f, 2.4f, 1}, right, back, image)
        .Quad({-2.5f, 2.4f, -1}, right, back, image + "\nAttribute 'shape' 'string emissionfilename' " + file)
        .Quad({1, 2.4f, 1}, right, back, Text::Area(2) + "\nAttribute 'shape' 'texture alpha' 'holes'")
        .Quad({1, 2, -1}, right, back, Text::Area(2) + "\nAttribute 'shape' 'float alpha' 0")
        .Sphere({-0.5f, 1.8f, -1}, 0.2f, Text::Area(3) + "\nAttribute 'shape' 'float alpha' 0")
        .Sphere({2.5f, 1.8f, 2}, 0.2f, Text::Area(3) + "\nAttribute 'shape' 'float zmax' 0.05")
        .Add("AttributeBegin\n" + Text::Area(2) +
             "\nTranslate -2 1 2\nRotate 70 1 1 0\nShape 'cylinder' 'float radius' 0.1\nAttributeEnd")
        .Add("AttributeBegin\n" + Text::Area(2, true) +
             "\nTranslate 0.6 1.2 2\nRotate 50 1 1 0\nShape 'disk' 'float radius' 0.3\nAttributeEnd")
        .Finish();
}

std::string Coincident() {
    Text t;
    t.Rooms();
    for (int i = 0; i < 8; ++i) {
        t.PointLight({-1.5f, 2, 1}, 1);
        t.Quad({1, 2.4f, 1}, {0.5f, 0, 0}, {0, 0, 0.5f}, Text::Area(1));
    }
    return t.Finish();
}

std::string Occluded() {
    Text t;
    t.Rooms();
    for (int i = 0; i < 4; ++i) {
        Point3 p(Float(i) * 1.3f - 2, 1.5f, 1.5f);
        t.Sphere(p, 0.3f);
        if (i % 2) t.PointLight(p, 5);
        else t.Sphere(p, 0.1f, Text::Area(10));
    }
    return t.Finish();
}

struct Recipe {
    std::string name;
    std::string text;
    int places = 14;
    bool dark = false;
};

const std::vector<Recipe> &Recipes() {
    static const std::vector<Recipe> recipes = {
        {"None", Text().Rooms().Finish(), 4, true},
        {"OnePoint", Text().Rooms().PointLight({-1.5f, 2, 1}, 3).Finish()},
        {"OneArea", Text().Rooms().Quad({1, 2.4f, 1}, {1, 0, 0}, {0, 0, 1}, Text::Area(3)).Finish()},
        {"Mixed", Mixed(1)},
        {"ScaledDown", Mixed(1e-4)},
        {"ScaledUp", Mixed(1e4)},
        {"InfiniteOnly", Text().Rooms().Sky(1).Sun({1, 2, -4}, 3).Sky(0.01).Finish()},
        {"SkyWindow",
         // A closed room with two openings, a sky with a bright spot, glass in one opening, a lamp.
         Text()
             .ClosedRoom()
             .ImageLight("infinite", "env_sky.exr", {0, 0, 0}, "Rotate 50 1 2 0", 1)
             .Quad({-1.6f, 0.8f, 3}, {1.2f, 0, 0}, {0, 1.2f, 0}, "Material 'dielectric'")
             .PointLight({0, 2, 0}, 0.1)
             .Finish()},
        {"MirroredSkyWindow", Text()
                                  .ClosedRoom()
                                  .Quad({0.4f, 0.8f, 3}, {1.2f, 0, 0}, {0, 1.2f, 0},
                                        "Material 'diffusetransmission' 'rgb transmittance' [ .4 .4 .4 ]")
                                  .ImageLight("infinite", "env_sky.exr", {0, 0, 0}, "Scale -1 1 1\nRotate 80 0 1 1", 2)
                                  .PointLight({0, 2, 0}, 0.1)
                                  .Finish()},
        {"TwoSkies",
         // One of one colour, whose whole is never sampled.
         Text()
             .ClosedRoom()
             .Sky(1)
             .ImageLight("infinite", "env_sky.exr", {0, 0, 0}, "Rotate 20 1 0 0", 1)
             .PointLight({0, 2, 0}, 0.1)
             .Sky(0)
             .Finish()},
        {"Images",
         // The open side of the rooms, towards the camera, is a portal; another one is walled up.
         Text()
             .Rooms()
             .Portal({-3, 0, -3}, {6, 0, 0}, {0, 2.5f, 0}, 0.5)
             .Portal({-2.9f, 0.5f, 1}, {0, 1, 0}, {0, 0, 1}, 3)
             .ImageLight("goniometric", "gonio_lobes.png", {-1.5f, 2, 1}, "Rotate 30 1 0 1", 3)
             .ImageLight("projection", "slide.png", {1.5f, 1.5f, -1}, "Rotate 40 1 1 0", 20)
             .PointLight({2, 2, 2}, 1)
             .Quad({1, 2.4f, 1}, {1, 0, 0}, {0, 0, 1}, Text::Area(1))
             .Finish()},
        {"AreaLights", AreaLights()},
        {"MeshOf10000", Text().Rooms().Bulb({-1.5f, 1.5f, 1.5f}, 0.5, 50, 100, 1).PointLight({2, 2, 2}, 1).Finish(), 3},
        {"NarrowBands", NarrowBands()},
        {"SunSphere",
         // A sun of real size in metres, and lamps.
         Text()
             .Rooms()
             .PointLight({-1, 2, 1}, 1)
             .Quad({1, 2.4f, 1}, {1, 0, 0}, {0, 0, 1}, Text::Area(3))
             .Sphere({3e10f, 6e10f, -1.3e11f}, 7e8f, Text::Area(1e5))
             .Finish()},
        {"ZeroPower", Text()
                          .Rooms()
                          .PointLight({-1, 2, 1}, 0)
                          .PointLight({1, 2, 1}, 2)
                          .Sky(0)
                          .Quad({-2, 2.4f, 0}, {1, 0, 0}, {0, 0, 1}, Text::Area(0, true))
                          .Quad({1, 2.4f, 0}, {1, 0, 0}, {0, 0, 1}, Text::Area(1))
                          .Finish()},
        {"AllZeroPower",
         Text().Rooms().PointLight({-1, 2, 1}, 0).PointLight({1, 2, 1}, 0).PointLight({2, 1, 1}, 0).Finish(), 4, true},
        {"Coincident", Coincident()},
        {"Occluded", Occluded(), 14, true},
    };
    return recipes;
}

const SampledWavelengths &Wavelengths() { return SampledWavelengths::WholeRange(); }

}  // namespace

std::vector<LightQuery> Places(const BuiltScene &built, int count, int depth, int bsdfEvery, std::deque<Bsdf> &bsdfs) {
    std::vector<LightQuery> out;
    const Scene &scene = *built.scene;
    Rng rng(99);
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    Vector2 size(built.film->FullResolution());
    for (int i = 0, attempts = 0; i < count && attempts < 1000; ++attempts) {
        CameraSample cs;
        cs.pFilm = rng.Uniform2() * size;
        std::optional<CameraRay> start = built.camera->GenerateRay(cs, lambda);
        std::optional<SurfacePoint> point = start ? scene.Intersect(start->ray) : std::nullopt;
        for (int bounce = 0; bounce < depth && point; ++bounce) {
            Bsdf bsdf = ComputeBsdf(scene, *point, lambda);
            if (!bsdf) break;
            if (bounce == i % depth) {
                LightQuery q = LightQueryAt({*point, bsdf}, lambda, bounce + 1);
                q.bsdf = i % bsdfEvery == 0 ? &bsdfs.emplace_back(bsdf) : nullptr;
                q.lambda = q.bsdf ? &Wavelengths() : nullptr;
                out.push_back(q);
                ++i;
                break;
            }
            Float uc = rng.Uniform();
            std::optional<BsdfSample> sample = bsdf.Sample(point->wo, uc, rng.Uniform2());
            if (!sample) break;
            point = scene.Intersect(point->SpawnRay(sample->wi));
        }
    }
    const Bounds3 &bounds = scene.Bounds();
    for (int i = 0; i < count; ++i) {
        LightQuery q;
        Vector3 t(rng.Uniform(), rng.Uniform(), rng.Uniform());
        q.p = bounds.low + (bounds.high - bounds.low) * t;
        q.n = SampleUniformSphere(rng.Uniform2());
        q.ns = i % 2 ? q.n : Normalize(q.n + SampleUniformSphere(rng.Uniform2()) * Float(0.3));
        q.wo = SampleUniformSphere(rng.Uniform2());
        q.transmits = i % 3 == 0;
        out.push_back(q);
    }
    for (size_t i = 0, n = out.size(); i < n; i += 2) {
        LightQuery q = out[i];
        q.n = q.ns = Normal3(0);
        q.bsdf = nullptr;
        q.lambda = nullptr;
        out.push_back(q);
    }
    return out;
}

namespace {

/// Adds places right at a few of the lights, with and without a surface.
void AddPlacesAtLights(const BuiltScene &built, std::vector<LightQuery> &queries) {
    const LightTable &lights = built.scene->Lights();
    const Bounds3 &bounds = built.scene->Bounds();
    Rng rng(7);
    for (int i = 0; i < 4 && lights.Size() > 0; ++i) {
        const LightCandidate light = lights.Candidate(LightId(rng.UniformInt(uint32_t(lights.Size()))));
        if (!light.bounds) continue;
        LightQuery q;
        q.p = light.bounds->Centroid() +
              SampleUniformSphere(rng.Uniform2()) * (Float(0.001) * Length(bounds.high - bounds.low));
        if (i % 2) q.n = q.ns = SampleUniformSphere(rng.Uniform2());
        q.wo = SampleUniformSphere(rng.Uniform2());
        queries.push_back(q);
    }
}

}  // namespace

double Contribution(const Scene &scene, const LightQuery &q, const LightComponent &light, const Point2 &u, Vector3 *wi,
                    bool allowIncompletePdfs) {
    LightSampleContext from{q.p, q.pError, q.n, q.ns, q.time};
    std::optional<LightLiSample> s = light.SampleLi(from, u, Wavelengths(), allowIncompletePdfs);
    if (!s || !s->L || !(s->pdf > 0)) return 0;
    if (wi) *wi = s->wi;
    Float cosine = 1;
    if (q.ns != Normal3(0)) {
        cosine = Dot(s->wi, q.ns);
        if (!q.transmits && cosine * Dot(q.wo, q.ns) <= 0) return 0;
        // Bounds are stored in few bits, so light at such grazing angles counts as none.
        if (std::abs(cosine) < Float(1e-5)) return 0;
        if (q.bsdf && !q.bsdf->F(q.wo, s->wi)) return 0;
    }
    if (scene.Occluded(from, *s)) return 0;
    return double(s->L.Average()) * double(std::abs(cosine)) / double(s->pdf);
}

double SceneFixture::Search(size_t query, LightId id) const {
    Rng rng(id.value);
    double sum = 0;
    for (int k = 0; k < points; ++k)
        sum += Contribution(*built.scene, queries[query], Lights()[id], rng.Uniform2()) / points;
    return sum;
}

double SceneFixture::ContributionOf(size_t query, LightId id) const {
    return id.value < Lights().Size() ? contribution[query][id.value] : Search(query, id);
}

std::unique_ptr<LightSampler> MakePreparedSampler(const std::string &label, const SceneFixture &fixture,
                                                  const PluginRegistry &registry) {
    size_t plus = label.find('+');
    std::unique_ptr<LightSampler> sampler = MakeLightSampler(
        label.substr(0, plus) + (plus != std::string::npos ? "+mesh" : ""), fixture.Lights(), registry);
    PrepareIn(fixture.built, *sampler);
    return sampler;
}

std::vector<std::string> SceneFixtureNames() {
    std::vector<std::string> names;
    for (const Recipe &r : Recipes()) names.push_back(r.name);
    return names;
}

const SceneFixture &SceneFixtureOf(const std::string &name) {
    static std::map<std::string, SceneFixture> fixtures;
    auto it = fixtures.find(name);
    if (it != fixtures.end()) return it->second;
    SceneFixture &f = fixtures[name];
    for (const Recipe &r : Recipes())
        if (r.name == name) {
            f.built = BuildText(r.text);
            f.queries = Places(f.built, r.places, 2, 3, f.bsdfs);
            AddPlacesAtLights(f.built, f.queries);
            f.dark = r.dark;
        }
    const size_t lights = f.Lights().Size();
    if (lights > 1000) f.points = 4;
    for (size_t q = 0; q < f.queries.size(); ++q) {
        std::vector<double> row;
        for (uint32_t l = 0; l < lights; ++l) row.push_back(f.Search(q, LightId(l)));
        f.contribution.push_back(row);
    }
    return f;
}

}  // namespace pbrt::test
