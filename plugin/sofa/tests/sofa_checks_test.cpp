// SPDX-License-Identifier: LGPL-2.1-or-later
// SOFA's own five checks of a force field, by its own helper: forces, and by differences of forces energy, addDForce,
// addKToMatrix and buildStiffnessMatrix. Compiled where SOFA's testing packages are.
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <sofa/component/solidmechanics/testing/ForceFieldTestCreation.h>
#include <sofa/component/topology/container/constant/MeshTopology.h>
#include <sofa/simulation/AnimateEndEvent.h>
#include <sofa/simulation/PropagateEventVisitor.h>

#include "hexaplast/body.hpp"

namespace hexaplast::sofa_plugin::test
{
namespace
{

constexpr double kYoung = 10;  // [Pa] as in the checks of SOFA's own hexahedra

/// A cube of 1 m without lateral contraction.
class SofasChecks : public sofa::ForceField_test<HexahedronElastoplasticFEMForceField<Vec3Types>>
{
protected:
    SofasChecks()
    {
        sofa::modeling::addNew<sofa::component::topology::container::constant::MeshTopology>(node)->addHexa(0, 1, 3, 2,
                                                                                                            4, 5, 7, 6);
        for (int n = 0; n < 8; ++n) rest.push_back({n % 2, n / 2 % 2, n / 4});
        dof->resize(8);
        dof->writeRestPositions().wref() = rest;
        force->findData("youngModulus")->read(std::to_string(kYoung));
        force->findData("poissonRatio")->read("0");
    }

    /// Of the cube, along x, beside which it stays as wide as it is.
    VecCoord stretched(double ratio) const
    {
        VecCoord x = rest;
        for (auto& place : x) place[0] *= ratio;
        return x;
    }
    /// Of a bar under the stress E (ratio - 1), a quarter of it on each node of either end.
    VecDeriv tension(double ratio) const
    {
        VecDeriv f(8);
        for (int n = 0; n < 8; ++n) f[n][0] = (n % 2 ? -1 : 1) * kYoung * (ratio - 1) / 4;
        return f;
    }
    /// Small changes of position, times the stiffness, against an error of `fraction` of that.
    void allow(double fraction)
    {
        errorMax = 1e4;
        deltaRange = {1, errorMax / (kYoung * fraction)};
    }

    const VecDeriv still = VecDeriv(8);
    VecCoord rest;
};

TEST_F(SofasChecks, HoldAtRest)
{
    allow(1e-3);
    run_test(rest, still, VecDeriv(8));
}

// The product leaves out how rotations change: that is the stress over Young's modulus, 1 % here.
TEST_F(SofasChecks, HoldInTension)
{
    allow(0.05);
    run_test(stretched(1.01), still, tension(1.01));
}

TEST_F(SofasChecks, HoldForForceAndEnergyInLargeTension)
{
    allow(0.5);
    run_test(stretched(1.1), still, tension(1.1));
}

TEST_F(SofasChecks, HoldWhereTheMaterialHasFlowed)
{
    force->findData("yieldStress")->read("0.1");
    force->findData("plasticFlowRate")->read("3");
    allow(0.1);
    setupState(stretched(1.05), still);
    node->setDt(0.1);
    sofa::simulation::node::initRoot(node.get());
    sofa::simulation::AnimateEndEvent end(0.1);
    node->propagateEvent(sofa::core::execparams::defaultInstance(), &end);

    const Body& body = *force->body();
    EXPECT_GT(body.fields(view(stretched(1.05))).plastic_strain[0], 1e-3);
    Body same(body.mesh(), body.materials(), body.settings());
    same.flow(view(stretched(1.05)), 0.1);
    same.linearize(view(stretched(1.04)));
    VecDeriv expected(8);
    same.add_force(view(expected));
    run_test(stretched(1.04), still, expected, false);
}

}  // namespace
}  // namespace hexaplast::sofa_plugin::test
