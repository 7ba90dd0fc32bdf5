#include "material_test_support.h"
#include "support/temporary_image.h"

namespace pbrt::test {
namespace {

struct FootprintShop : Workshop {
    void Define(const std::string &name, const std::string &textureClass, const Params &params,
                bool isSpectrum = true) {
        textures.Define(name, isSpectrum, textureClass, params, Transform());
    }
    Params Map(const std::string &filter) {
        return Params().String("filename", noise_.Path()).String("filter", filter);
    }
    MaterialPtr Diffuse(const std::string &texture) {
        return Make("diffuse", Params().Texture("reflectance", texture));
    }
    const TemporaryImage noise_{"footprint.exr", RgbImage({64, 64}, [](int x, int y) {
                                    auto value = [&](int c) { return Float((x * 7 + y * 13 + c) % 17) / 17; };
                                    return Rgb(value(0), value(5), value(10));
                                })};
};

/// What a material scatters at a point with or without a footprint.
SampledSpectrum Scattered(const Material &material, bool footprint) {
    SurfacePoint s = TestPoint();
    if (footprint) {
        s.dpdx = Vector3(0.7f, 0, 0.2f);
        s.dpdy = Vector3(0, 0.4f, 0.1f);
        s.dudx = 0.3f;
        s.dvdy = 0.4f;
    }
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.4f);
    const Material *resolved = material.Resolve(s);
    resolved->PerturbShading(s);
    const Vector3 wi = Normalize(s.n + 0.2f * s.wo);
    return resolved->GetBsdf(s, lambda).F(s.wo, wi) * AbsDot(wi, s.shading.n);
}

// NeedsFootprint() must be true exactly where the footprint changes what is scattered.
void ExpectFlagIsRight(const MaterialPtr &material, bool needs, const std::string &what) {
    EXPECT_EQ(material->NeedsFootprint(), needs) << what;
    const SampledSpectrum without = Scattered(*material, false), with = Scattered(*material, true);
    bool differs = false;
    for (int i = 0; i < SpectrumSamples; ++i) differs |= without[i] != with[i];
    EXPECT_EQ(differs, needs) << what;
}

TEST(Footprint, IsNeededExactlyWhereItChangesWhatIsScattered) {
    FootprintShop shop;
    ExpectFlagIsRight(shop.Make("diffuse"), false, "constant");
    shop.Define("plain", "scale", Params().Rgb("tex", 0.3f, 0.4f, 0.5f).Number("scale", 0.5f));
    ExpectFlagIsRight(shop.Diffuse("plain"), false, "scaled constant");
    shop.Define("corners", "bilerp", Params().Rgb("v00", 0.3f, 0.4f, 0.5f));
    ExpectFlagIsRight(shop.Diffuse("corners"), false, "bilerp");
    shop.Define("dots", "dots", Params().Rgb("inside", 0.3f, 0.4f, 0.5f).Rgb("outside", 0.5f, 0.3f, 0.1f));
    ExpectFlagIsRight(shop.Diffuse("dots"), false, "dots");
    // The filters point and bilinear choose a mipmap level by the footprint, too, as in stock pbrt-v4.
    for (const char *filter : {"point", "bilinear", "trilinear", "EWA"}) {
        shop.Define(filter, "imagemap", shop.Map(filter));
        ExpectFlagIsRight(shop.Diffuse(filter), true, filter);
        const std::string scaled = std::string("scaled ") + filter;
        shop.Define(scaled, "scale", Params().Texture("tex", filter).Number("scale", 0.5f));
        ExpectFlagIsRight(shop.Diffuse(scaled), true, scaled);
        const std::string mixed = std::string("mixed ") + filter;
        shop.Define(mixed, "mix", Params().Texture("tex1", "plain").Texture("tex2", filter).Number("amount", 0.5f));
        ExpectFlagIsRight(shop.Diffuse(mixed), true, mixed);
    }
    shop.Define("checks", "checkerboard", Params());
    ExpectFlagIsRight(shop.Diffuse("checks"), true, "checkerboard");
    shop.Define("marble", "marble", Params().Number("scale", 3));
    ExpectFlagIsRight(shop.Diffuse("marble"), true, "marble");
    for (const char *octaves : {"fbm", "wrinkled", "windy"}) {
        shop.Define(octaves, octaves, Params(), false);
        const std::string scaled = std::string("scaled by ") + octaves;
        shop.Define(scaled, "scale", Params().Rgb("tex", 0.3f, 0.4f, 0.5f).Texture("scale", octaves));
        ExpectFlagIsRight(shop.Diffuse(scaled), true, scaled);
    }
}

TEST(Footprint, IsNeededByBumpsAndByWhatAMixtureOrAStandInIsMadeOf) {
    FootprintShop shop;
    shop.Define("sharp", "dots", Params());
    shop.Define("soft", "imagemap", shop.Map("trilinear"));
    // A height that uses no footprint itself, but whose measured slope depends on the size of the footprint.
    shop.Define("slope", "bilerp", Params().Number("v11", 4), false);
    shop.Define("bent", "scale", Params().Texture("tex", "slope").Texture("scale", "slope"), false);
    ExpectFlagIsRight(shop.Make("diffuse", Params().Texture("displacement", "bent")), true, "bump map");

    shop.named = {{"sharp", shop.Diffuse("sharp")}, {"soft", shop.Diffuse("soft")}};
    auto mix = [&](const char *other) {
        return shop.Make("mix", Params("mix").Strings("materials", {"sharp", other}));
    };
    EXPECT_FALSE(mix("sharp")->NeedsFootprint());
    EXPECT_TRUE(mix("soft")->NeedsFootprint());
    EXPECT_FALSE(ForceDiffuse(shop.named["sharp"])->NeedsFootprint());
    EXPECT_TRUE(ForceDiffuse(shop.named["soft"])->NeedsFootprint());
}

}  // namespace
}  // namespace pbrt::test
