// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <Hexaplast/fields.h>
#include <Hexaplast/releases.h>
#include <sofa/helper/OptionsGroup.h>

#include <functional>
#include <locale>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include "attributes/admissible.hpp"
#include "attributes/words.hpp"
#include "hexaplast/material/rows.hpp"
#include "parts/option.hpp"

/// Data as the attribute table describes them, so that names, defaults and help stand once for all hosts.
namespace hexaplast::sofa_plugin
{

using attributes::Attribute;
using attributes::Description;
using sofa::core::objectmodel::Data;
using sofa::helper::OptionsGroup;

/// A word. Of one that it does not have, an OptionsGroup warns, and keeps the word before; this one remembers what it
/// was given, so that its component can refuse it.
class DataWord final : public Data<OptionsGroup>
{
public:
    explicit DataWord(const InitData& init) : Data<OptionsGroup>(init) {}

    bool read(const std::string& text) override
    {
        const bool is_read = Data<OptionsGroup>::read(text);
        m_read = text;
        m_counterRead = getCounter();
        return is_read;
    }

    /// The word that it was given latest, whether it has it or not.
    std::string given() const
    {
        const std::string& selected = getValue().getSelectedItem();
        return m_counterRead == getCounter() ? m_read : selected;
    }

private:
    std::string m_read;
    int m_counterRead = -1;
};

/// The group of a member of Material or Settings; that of none is empty.
inline std::string group_of(std::string_view name)
{
    if (const auto* row = find_row(material_rows(), name, Names::kScenes)) return std::string(row->group);
    if (const auto* row = find_row(settings_rows(), name, Names::kScenes)) return std::string(row->group);
    return {};
}

inline std::string help_of(const Attribute& attribute)
{
    std::string help(attribute.help);
    if (!attribute.words.empty()) help += fmt::format(" One of: {}.", attribute.words);
    if (const std::string range = attributes::describe(attribute.range); !range.empty())
        help += fmt::format(" It {}.", range);
    if (!attribute.unit.empty()) help += fmt::format(" [{}]", attribute.unit);
    return help;
}

template <class T>
T initial_value(const Attribute& attribute)
{
    if constexpr (std::is_same_v<T, OptionsGroup>)
    {
        OptionsGroup words(attributes::split_words(attribute.words));
        words.setSelectedItem(std::string(attribute.initial));
        return words;
    }
    else
    {
        T value{};
        if (attribute.initial.empty()) return value;
        std::istringstream text{std::string(attribute.initial)};
        text.imbue(std::locale::classic());
        text >> std::boolalpha >> value;
        return value;
    }
}

/// The Data in which SOFA keeps an option or an output.
template <class T>
struct DataOf
{
    using type = Data<T>;
};
template <class T>
struct DataOf<std::optional<T>> : DataOf<T>
{
};
template <class T>
requires std::is_enum_v<T>
struct DataOf<T>
{
    using type = DataWord;
};
template <>
struct DataOf<hexaplast::Vec3> : DataOf<sofa::type::Vec3>
{
};
template <>
struct DataOf<PointArray> : DataOf<sofa::type::vector<sofa::type::Vec3>>
{
};
template <>
struct DataOf<std::vector<double>> : DataOf<sofa::type::vector<SReal>>
{
};
template <>
struct DataOf<std::vector<int>> : DataOf<sofa::type::vector<sofa::Index>>
{
};
template <>
struct DataOf<std::span<const int>> : DataOf<sofa::type::vector<sofa::Index>>
{
};
template <>
struct DataOf<std::vector<Triangle>> : DataOf<MeshTopology::SeqTriangles>
{
};

/// What a Data of a component is made from. group: where the row has none.
template <class T>
typename Data<T>::InitData from_table(SofaComponent& owner, Data<T>& data, const Attribute& attribute,
                                      const char* group)
{
    const bool is_output = attribute.access == attributes::Access::kOutput;
    const std::string of_row = group_of(attribute.name);
    auto init = owner.initData(&data, initial_value<T>(attribute), std::string(attribute.name).c_str(),
                               help_of(attribute).c_str(), true, is_output);
    init.group = is_output                  ? "Outputs"
                 : !of_row.empty()          ? of_row
                 : !attribute.group.empty() ? std::string(attribute.group)
                                            : group;
    return init;
}

/// An option of a part from the Data that has its name.
template <class T>
void read_option(const sofa::core::BaseData& data, const Attribute& attribute, T& option)
{
    const auto& given = dynamic_cast<const typename DataOf<T>::type&>(data);
    if constexpr (std::is_enum_v<T>)
        option = static_cast<T>(parts::place_of_word(attribute, given.given()));
    else if constexpr (std::is_same_v<T, hexaplast::Vec3>)
        option = vec3(given.getValue());
    else if constexpr (std::is_same_v<T, std::vector<double>>)
        option = reals(given.getValue());
    else if constexpr (std::is_same_v<T, std::vector<int>>)
        option = whole_numbers(given.getValue());
    else if constexpr (std::is_same_v<T, PointArray>)
        option = view(given.getValue());
    else if constexpr (std::is_same_v<T, std::vector<Triangle>>)
        option = triangles(given.getValue());
    else
        option = given.getValue();
}
template <class T>
void read_option(const sofa::core::BaseData& data, const Attribute& attribute, std::optional<T>& option)
{
    if (data.isSet()) read_option(data, attribute, option.emplace());
}

/// An output into the Data that has its name.
template <class T>
void write_output(sofa::core::BaseData& data, const T& output)
{
    auto& shown = dynamic_cast<typename DataOf<T>::type&>(data);
    if constexpr (std::is_same_v<T, hexaplast::Vec3>)
    {
        shown.setValue(vec3(output));
    }
    else if constexpr (std::is_same_v<T, std::span<const int>>)
    {
        shown.beginWriteOnly()->assign(output.begin(), output.end());
        shown.endEdit();
    }
    else
    {
        shown.setValue(output);
    }
}

/// The options of a part from the Data of its component. Throws OptionError for a word that there is not, with what
/// else is wrong.
template <class Options>
Options read_options(const SofaComponent& owner, const Description& description)
{
    Options options;
    parts::OptionErrors errors;
    Options::each(options,
                  [&](std::string_view option, auto& member)
                  {
                      const std::string name = parts::attribute_name(option);
                      errors.collect(
                          [&]
                          { read_option(*owner.findData(name), attributes::attribute_of(description, name), member); });
                  });
    if (errors.empty()) return options;
    errors.collect([&] { parts::OptionRanges(description, options).throw_all(); });
    errors.throw_all();
    return options;
}

/// A component whose Data are attributes of a table.
template <class TBase>
class TableComponent : public TBase
{
public:
    SOFA_ABSTRACT_CLASS(SOFA_TEMPLATE(TableComponent, TBase), TBase);

protected:
    explicit TableComponent(const Description& description) : m_description(description) {}

    const Description& description() const { return m_description; }

    /// What a Data is made from: Data<SReal> d_length{this->fromTable(d_length, "length")}. `group`: under which
    /// windows show it, where its row has no group.
    template <class T>
    typename Data<T>::InitData fromTable(Data<T>& data, std::string_view name, const char* group = "")
    {
        return from_table(*this, data, attributes::attribute_of(m_description, name), group);
    }

    /// Makes a Data for each option and each output of a part.
    template <class Part>
    void makeData()
    {
        typename Part::Options options;
        Part::Options::each(options, [&](std::string_view option, const auto& member)
                            { makeDataOf<std::remove_cvref_t<decltype(member)>>(parts::attribute_name(option)); });
        Part::outputs([&](std::string_view output, const auto& of)
                      { makeDataOf<std::remove_cvref_t<std::invoke_result_t<decltype(of), const Part&>>>(output); });
    }

    /// For links, which SOFA makes in the class that has them: l_body{initLink("body", helpOf("body"))}.
    const char* helpOf(std::string_view name) const
    {
        return attributes::attribute_of(m_description, name).help.data();
    }

    /// The options of a part from the Data. Throws OptionError.
    template <class Options>
    Options readOptions() const
    {
        return read_options<Options>(*this, m_description);
    }

private:
    struct Owned
    {
        virtual ~Owned() = default;
    };
    template <class TData>
    struct OwnedData final : Owned
    {
        OwnedData(TableComponent& owner, std::string_view name) : data(owner.fromTable(data, name)) {}
        TData data;
    };

    template <class T>
    void makeDataOf(std::string_view name)
    {
        m_data.push_back(std::make_unique<OwnedData<typename DataOf<T>::type>>(*this, name));
    }

    const Description& m_description;
    std::vector<std::unique_ptr<Owned>> m_data;
};

/// The inputs of a component that has the attributes of a table: whether a value changed since they were seen last.
class Inputs
{
public:
    Inputs(const SofaComponent& owner, const Description& description)
    {
        for (const Attribute& attribute : description.attributes)
            if (const auto* data = owner.findData(std::string(attribute.name)))
                if (attribute.access != attributes::Access::kOutput) m_data.push_back({data, data->getCounter()});
    }

    bool have_changed()
    {
        bool changed = false;
        for (auto& [data, counter] : m_data)
        {
            data->updateIfDirty();  // where it follows another one
            changed = changed || counter != data->getCounter();
            counter = data->getCounter();
        }
        return changed;
    }

private:
    struct Seen
    {
        const sofa::core::BaseData* data;
        int counter;
    };
    std::vector<Seen> m_data;
};

}  // namespace hexaplast::sofa_plugin
