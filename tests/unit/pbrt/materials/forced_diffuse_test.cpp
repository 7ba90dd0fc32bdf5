#include "material_test_support.h"
#include "pbrt/bxdfs/bsdf.h"

namespace pbrt::test {
namespace {

Bsdf BsdfOf(const Material &m) {
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    return m.GetBsdf(TestPoint(), lambda);
}

TEST(ForcedDiffuse, IsLambertWithTheAlbedoOfTheOriginal) {
    Workshop shop;
    for (const char *type : {"conductor", "dielectric", "coateddiffuse", "diffusetransmission", "diffuse"}) {
        const MaterialPtr original = shop.Make(type);
        const Bsdf forced = BsdfOf(*ForceDiffuse(original));
        EXPECT_EQ(forced.Flags(), BxdfFlags::Diffuse | BxdfFlags::Reflection) << type;
        const SampledSpectrum albedo = EstimateAlbedo(BsdfOf(*original), TestPoint().wo);
        const SampledSpectrum f = forced.F(TestPoint().wo, Vector3(TestPoint().n));
        for (int i = 0; i < SpectrumSamples; ++i) {
            EXPECT_GT(albedo[i], 0) << type;
            EXPECT_NEAR(f[i], std::min(albedo[i], Float(1)) * InvPi, 1e-5) << type;
        }
    }
}

TEST(ForcedDiffuse, DiffuseInterfacesAndMixturesStay) {
    Workshop shop;
    const MaterialPtr diffuse = shop.Make("diffuse");
    ExpectSameScattering(BsdfOf(*diffuse), BsdfOf(*ForceDiffuse(diffuse)));
    const MaterialPtr air = shop.Make("interface");
    EXPECT_EQ(ForceDiffuse(air), air);
    shop.named["a"] = ForceDiffuse(shop.Make("conductor"));
    shop.named["b"] = ForceDiffuse(shop.Make("dielectric"));
    const MaterialPtr mix = ForceDiffuse(shop.Make("mix", Params("mix").Strings("materials", {"a", "b"})));
    const Material *chosen = mix->Resolve(TestPoint());
    EXPECT_TRUE(chosen == shop.named["a"].get() || chosen == shop.named["b"].get());
}

}  // namespace
}  // namespace pbrt::test
