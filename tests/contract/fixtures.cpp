#include "fixtures.h"

#include "pbrt/lights/light_factory.h"
#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/shapes/shape_factory.h"
#include "pbrt/shapes/triangle_mesh.h"
#include "support/param.h"

namespace pbrt::test {

namespace {

/// Collects lights; all lengths are in units of `scale`.
class Builder {
  public:
    explicit Builder(Float scale = 1) : ctm_(Transform::Scale(Vector3(scale))), scale_(scale) {
        fixture_->owned = std::make_unique<LightTable>();
    }

    void AddLight(const std::string &type, std::vector<Param> params) {
        ParamSet set("LightSource \"" + type + "\"", {});
        for (Param &p : params) set.Add(std::move(p));
        fixture_->owned->Add(Lights().Make(type, set, Context()));
    }
    void AddPoint(const Point3 &p, Float intensity) {
        AddLight("point", {FloatParam("from", {p.x, p.y, p.z}, ParamType::Point3), Scale(intensity)});
    }
    /// A point light of a line of 4 nm.
    void AddLine(const Point3 &p, Float nm, Float intensity) {
        AddLight("point", {FloatParam("from", {p.x, p.y, p.z}, ParamType::Point3),
                           FloatParam("I", {nm - 2, 0, nm, 1, nm + 2, 0}, ParamType::Spectrum), Scale(intensity)});
    }
    void AddSpot(const Point3 &from, const Point3 &to, Float angle, Float delta, Float intensity) {
        AddLight("spot", {FloatParam("from", {from.x, from.y, from.z}, ParamType::Point3),
                          FloatParam("to", {to.x, to.y, to.z}, ParamType::Point3), FloatParam("coneangle", {angle}),
                          FloatParam("conedeltaangle", {delta}), Scale(intensity)});
    }
    void AddSky(Float radiance) { AddLight("infinite", {Scale(radiance)}); }
    void AddSun(const Vector3 &to, Float irradiance) {
        AddLight("distant", {FloatParam("to", {to.x, to.y, to.z}, ParamType::Point3), Scale(irradiance)});
    }
    void AddImage(const std::string &type, const std::string &asset, std::vector<Param> params) {
        params.push_back(StringParam("filename", PBRT_SOURCE_DIR "/tests/conformance/suite/scenes/assets/" + asset));
        AddLight(type, std::move(params));
    }
    void AddGoniometric(Float intensity) { AddImage("goniometric", "gonio_lobes.png", {Scale(intensity)}); }
    void AddProjection(Float fov, Float intensity) {
        AddImage("projection", "slide.png", {Scale(intensity), FloatParam("fov", {fov})});
    }
    void AddImageSky(Float radiance) { AddImage("infinite", "env_sky.exr", {Scale(radiance)}); }
    /// The sky through the rectangle p, p + a, p + a + b, p + b; it shines against cross(b, a).
    void AddPortal(const Point3 &p, const Vector3 &a, const Vector3 &b, Float radiance) {
        std::vector<Float> v;
        for (Point3 q : {p, p + a, p + a + b, p + b})
            for (int i = 0; i < 3; ++i) v.push_back(q[i] * scale_);
        AddImage("infinite", "env_sky.exr", {Scale(radiance), FloatParam("portal", std::move(v), ParamType::Point3)});
    }
    void AddMesh(MeshData mesh, bool twoSided, Float radiance) {
        AddShape(std::make_unique<TriangleMesh>(std::move(mesh), ctm_, false), twoSided, radiance);
    }
    void AddTriangle(const Point3 &p, const Vector3 &e1, const Vector3 &e2, bool twoSided, Float radiance) {
        MeshData mesh;
        mesh.p = {p, p + e1, p + e2};
        mesh.indices = {0, 1, 2};
        AddMesh(std::move(mesh), twoSided, radiance);
    }
    void AddQuadric(const std::string &type, const Transform &place, bool twoSided, Float radiance) {
        ParamSet none("Shape \"" + type + "\"", {});
        const Transform there = ctm_ * place;
        for (auto &shape : Shapes().Make(type, none, ShapeContext{there, false, files_, sink_, ParamReader(none)}))
            AddShape(std::move(shape), twoSided, radiance);
    }

    /// Places in and around the box [low, high], and right at the lights: with normals, with tilted shading normals,
    /// and without normals.
    std::unique_ptr<ContractFixture> Finish(int queries = 24, Point3 low = Point3(-1), Point3 high = Point3(1)) {
        fixture_->owned->Finish(Point3(0), 3 * scale_);
        fixture_->lights = fixture_->owned.get();
        Rng rng(99);
        for (int i = 0; i < queries; ++i) {
            LightQuery q;
            Vector3 t(rng.Uniform(), rng.Uniform(), rng.Uniform());
            q.p = (low + (high - low) * (t * Float(1.5) - Float(0.25))) * scale_;
            const auto lights = static_cast<uint32_t>(fixture_->lights->Size());
            if (i % 6 == 5 && lights > 0) {
                const LightCandidate c = fixture_->lights->Candidate(LightId(rng.UniformInt(lights)));
                if (c.bounds) q.p = c.bounds->Centroid() + SampleUniformSphere(rng.Uniform2()) * (Float(0.01) * scale_);
            }
            if (i % 3 != 2) {
                q.n = SampleUniformSphere(rng.Uniform2());
                q.ns = i % 3 == 0 ? q.n : Normalize(q.n + SampleUniformSphere(rng.Uniform2()) * Float(0.3));
            }
            q.wo = SampleUniformSphere(rng.Uniform2());
            q.transmits = i % 4 == 1;
            fixture_->queries.push_back(q);
        }
        return std::move(fixture_);
    }

  private:
    LightContext Context() { return {ctm_, ctm_, ColorSpace::SRGB(), files_, sink_}; }
    static Param Scale(Float v) { return FloatParam("scale", {v}); }
    void AddShape(std::unique_ptr<Shape> shape, bool twoSided, Float radiance) {
        ParamSet set("AreaLightSource \"diffuse\"", {});
        set.Add(Scale(radiance));
        set.Add(BoolParam("twosided", twoSided));
        const AreaLightMaker maker = AreaLights().Make("diffuse", set, Context());
        const Shape *const shapes[] = {shape.get()};
        fixture_->owned->Add(maker(shapes, nullptr));
        fixture_->shapes.push_back(std::move(shape));
    }

    std::unique_ptr<ContractFixture> fixture_ = std::make_unique<ContractFixture>();
    FileResolver files_;
    DiagnosticSink sink_;
    Transform ctm_;
    Float scale_;
};

/// A bumpy ball.
MeshData Ball(int rings, int segments, Float radius, const Point3 &center) {
    MeshData mesh;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < segments; ++j) {
            Float theta = Pi * (static_cast<Float>(i) + Float(0.5)) / static_cast<Float>(rings + 1);
            Float phi = 2 * Pi * static_cast<Float>(j) / static_cast<Float>(segments);
            Float bump = radius * (1 + Float(0.1) * std::sin(5 * phi) * std::sin(7 * theta));
            mesh.p.push_back(center + SphericalDirection(std::sin(theta), std::cos(theta), phi) * bump);
        }
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < segments; ++j) {
            auto at = [&](int ring, int segment) {
                return static_cast<uint32_t>(ring * segments + segment % segments);
            };
            mesh.indices.insert(mesh.indices.end(), {at(i, j), at(i + 1, j), at(i, j + 1)});
            mesh.indices.insert(mesh.indices.end(), {at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

std::unique_ptr<ContractFixture> Many(Float scale) {
    Builder b(scale);
    Rng rng(5);
    auto place = [&] { return Point3(2 * rng.Uniform() - 1, 2 * rng.Uniform() - 1, 2 * rng.Uniform() - 1); };
    b.AddSky(Float(0.3));
    for (int i = 0; i < 10; ++i) {
        b.AddPoint(place(), (Float(0.2) + rng.Uniform()) * scale * scale);
        Point3 from = place();
        b.AddSpot(from, from + SampleUniformSphere(rng.Uniform2()), 5 + 70 * rng.Uniform(), 5 * rng.Uniform(),
                  2 * scale * scale);
        b.AddTriangle(place(), SampleUniformSphere(rng.Uniform2()) * Float(0.3),
                      SampleUniformSphere(rng.Uniform2()) * Float(0.3), i % 2 == 0, 1 + 3 * rng.Uniform());
        Point3 center = place();
        b.AddQuadric(i % 2 ? "sphere" : "disk",
                     Transform::Translate(center) * Transform::Rotate(360 * rng.Uniform(), place()) *
                         Transform::Scale(Vector3(Float(0.02) + Float(0.1) * rng.Uniform())),
                     false, 4);
    }
    b.AddSun({1, -2, 0.5f}, 1);
    return b.Finish();
}

/// Lines beside lights of all wavelengths; radiances in units of `radiance`.
std::unique_ptr<ContractFixture> NarrowBands(Float radiance) {
    Builder b;
    b.AddPoint({0.5f, 0, 0}, radiance);
    for (int i = 0; i < 5; ++i)
        b.AddLine(Point3(Float(0.4) * static_cast<Float>(i) - 1, 0.7f, 0.3f), 400 + 80 * static_cast<Float>(i),
                  radiance);
    b.AddTriangle({0, 0, 0.5f}, {1, 0, 0}, {0, 1, 0}, true, radiance);
    b.AddMesh(Ball(3, 4, Float(0.3), Point3(-0.6f, 0, 0)), false, radiance);
    b.AddSun({1, -2, 0.5f}, radiance);
    b.AddImageSky(radiance / 10);
    return b.Finish();
}

}  // namespace

const std::vector<FixtureEntry> &ContractFixtures() {
    static const std::vector<FixtureEntry> fixtures = {
        {"None", [] { return Builder().Finish(6); }},
        {"OneTriangle",
         [] {
             Builder b;
             b.AddTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, false, 2);
             return b.Finish();
         }},
        {"OneSpot",
         [] {
             Builder b;
             b.AddSpot({0, 0, 1}, {0, 0, 0}, 40, 10, 5);
             return b.Finish();
         }},
        {"OneSky",
         [] {
             Builder b;
             b.AddSky(1);
             return b.Finish();
         }},
        {"Many", [] { return Many(1); }},
        {"ScaledDown", [] { return Many(Float(1e-4)); }},
        {"ScaledUp", [] { return Many(Float(1e4)); }},
        {"InfiniteOnly",
         [] {
             Builder b;
             b.AddSky(1);
             b.AddSun({1, 1, 1}, 3);
             b.AddSky(Float(0.01));
             return b.Finish();
         }},
        {"OnePortal",
         [] {
             Builder b;
             b.AddPortal({-0.5f, -0.5f, 1}, {0, 1, 0}, {1, 0, 0}, 1);
             return b.Finish();
         }},
        {"Images",
         [] {
             Builder b;
             b.AddGoniometric(2);
             b.AddProjection(70, 3);
             b.AddPoint({0.5f, 0, 0}, 1);
             b.AddPortal({-0.5f, -0.5f, 1}, {0, 1, 0}, {1, 0, 0}, 1);
             b.AddPortal({1, -0.5f, -0.5f}, {0, 0, 1}, {0, 1, 0}, 2);
             b.AddImageSky(Float(0.1));
             b.AddTriangle({0, 0, 0.5f}, {1, 0, 0}, {0, 1, 0}, true, 1);
             return b.Finish();
         }},
        {"NarrowBands", [] { return NarrowBands(1); }},
        {"NarrowBandsBright", [] { return NarrowBands(1e29f); }},
        {"NarrowBandsDim", [] { return NarrowBands(1e-29f); }},
        {"SunSphere",
         [] {
             // A sun of real size in metres. It and the lamp bring about as much light to the places between them.
             Builder b;
             b.AddQuadric("sphere", Transform::Translate({0, 1.5e11f, 0}) * Transform::Scale(Vector3(7e8f)), false,
                          5e4f);
             b.AddPoint({0, 2, 0}, 10);
             return b.Finish();
         }},
        {"MeshOf10000",
         [] {
             Builder b;
             b.AddMesh(Ball(50, 100, Float(0.5), Point3(0)), false, 1);
             return b.Finish(3);
         }},
        {"MeshesAndOthers",
         [] {
             Builder b;
             b.AddMesh(Ball(10, 12, Float(0.3), Point3(0.6f, 0, 0)), false, 1);
             b.AddPoint({0, 0.5f, 0}, 1);
             b.AddMesh(Ball(6, 8, Float(0.2), Point3(-0.6f, 0, 0)), true, 5);
             b.AddSky(Float(0.1));
             return b.Finish();
         }},
        {"SomeZeroPower",
         [] {
             Builder b;
             b.AddPoint({0, 0, 0}, 0);
             b.AddTriangle({0, 0, 0.5f}, {1, 0, 0}, {0, 1, 0}, true, 3);
             b.AddTriangle({0, 0, -0.5f}, {1, 0, 0}, {0, 1, 0}, true, 0);
             b.AddPoint({1, 0, 0}, 2);
             b.AddSky(0);
             return b.Finish();
         }},
        {"AllZeroPower",
         [] {
             Builder b;
             for (int i = 0; i < 3; ++i) b.AddPoint(Point3(static_cast<Float>(i)), 0);
             return b.Finish(6);
         }},
        {"Coincident",
         [] {
             Builder b;
             for (int i = 0; i < 20; ++i) {
                 b.AddPoint({0.1f, 0.2f, 0.3f}, 1);
                 b.AddTriangle({0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}, false, 1);
             }
             return b.Finish();
         }},
    };
    return fixtures;
}

}  // namespace pbrt::test
