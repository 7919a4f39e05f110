// SPDX-License-Identifier: LGPL-2.1-or-later
#include <Hexaplast/HexahedronElastoplasticFEMForceField.h>
#include <Hexaplast/errors.h>
#include <Hexaplast/registration.h>
#include <sofa/core/objectmodel/DataFileName.h>
#include <sofa/simulation/UpdateMappingEndEvent.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>

#include "hexaplast/body.hpp"

namespace hexaplast::sofa_plugin
{

namespace
{

/// Lists of numbers in JSON, with all digits; null stands for infinity.
class ListsFile
{
public:
    explicit ListsFile(const std::string& file) : m_file(file)
    {
        m_file.imbue(std::locale::classic());
        m_file.precision(std::numeric_limits<double>::max_digits10);
        m_file << "{";
    }
    void add(const char* name, ConstPoints points)
    {
        begin(name);
        for (Eigen::Index n = 0; n < points.rows(); ++n)
        {
            m_file << (n == 0 ? "\n[" : ",\n[");
            for (int i = 0; i < 3; ++i) add(points(n, i), i == 0);
            m_file << "]";
        }
        m_file << "]";
    }
    void add(const char* name, const std::vector<double>& values)
    {
        begin(name);
        for (std::size_t e = 0; e < values.size(); ++e) add(values[e], e == 0);
        m_file << "]";
    }
    bool end()
    {
        m_file << "}\n";
        m_file.close();
        return !m_file.fail();
    }

private:
    void begin(const char* name)
    {
        m_file << (m_isFirst ? "\n\"" : ",\n\"") << name << "\": [";
        m_isFirst = false;
    }
    void add(double value, bool isFirst)
    {
        if (!isFirst) m_file << ", ";
        if (std::isnan(value)) throw InputError("the state holds a number that is not one (NaN)");
        if (std::isinf(value))
            m_file << "null";
        else
            m_file << value;
    }

    std::ofstream m_file;
    bool m_isFirst = true;
};

}  // namespace

constexpr attributes::Description kFinalStateExporter{
    .class_name = "FinalStateExporter",
    .category = "Exporter",
    .help =
        "Writes positions, velocities, plastic rest positions, volume ratios and yield stresses of a body after a step "
        "with all digits, under the names of hexaplast run --final. Stands behind the force field in its node.",
    .templates = ""};

/// Writes the state after a step in full precision.
class FinalStateExporter final : public SofaComponent
{
public:
    SOFA_CLASS(FinalStateExporter, SofaComponent);

    void init() override
    {
        if (d_filename.getValue().empty() || d_step.getValue() < 1)
        {
            msg_error() << "needs filename, and exportAtStep of at least 1";
            d_componentState.setValue(sofa::core::objectmodel::ComponentState::Invalid);
        }
    }
    void reset() override { m_numSteps = 0; }

    void handleEvent(sofa::core::objectmodel::Event* event) override
    {
        if (!sofa::simulation::UpdateMappingEndEvent::checkEventType(event) || !mayStep(*this)) return;
        if (++m_numSteps != d_step.getValue()) return;
        HexahedronElastoplasticFEMForceField* field = nullptr;
        getContext()->get(field, sofa::core::objectmodel::BaseContext::SearchUp);
        const Body* body = field ? field->body() : nullptr;
        if (!body)
        {
            msg_error() << "finds no body in its node or above";
            return;
        }
        if (!field->works())
        {
            msg_error() << "writes nothing: '" << field->getPathName() << "' is invalid (see its error above)";
            return;
        }
        attempt(*this, [&] { write(*field->getMState(), *body); });
    }

protected:
    FinalStateExporter()
        : d_filename(initData(&d_filename, "filename", "The JSON file.")),
          d_step(initData(&d_step, 0, "exportAtStep", "The step after which the state is written."))
    {
        f_listening.setValue(true);
    }

private:
    /// Whole or not at all.
    void write(const MechanicalState& state, const Body& body) const
    {
        const std::string file = d_filename.getFullPath(), unfinished = file + ".part";
        const auto x = view(state.readPositions().ref());
        const ElementFields fields = body.fields(x);
        ListsFile out(unfinished);
        out.add("positions", x);
        out.add("velocities", view(state.readVelocities().ref()));
        out.add("plastic_rest_positions", body.plastic_rest_positions());
        out.add("volume_ratio", fields.volume_ratio);
        out.add("yield_stress", fields.yield_stress);
        const bool isWritten = out.end();
        std::error_code error;
        if (isWritten) std::filesystem::rename(unfinished, file, error);
        if (isWritten && !error) return;
        std::filesystem::remove(unfinished, error);
        throw parts::OptionError("filename", "'" + file + "' cannot be written");
    }

    sofa::core::objectmodel::DataFileName d_filename;  ///< the JSON file
    sofa::core::objectmodel::Data<int> d_step;         ///< after which the state is written
    int m_numSteps = 0;
};

[[maybe_unused]] const bool kFinalStateExporterIsRegistered =
    registerComponent<FinalStateExporter>(kFinalStateExporter);

}  // namespace hexaplast::sofa_plugin
