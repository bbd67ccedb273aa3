// SPDX-License-Identifier: Apache-2.0
#include "pqAnamorphNamedWeights.h"

#include <QHeaderView>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QTableWidget>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "number_text.h"
#include "pqApplicationCore.h"
#include "pqServerManagerModel.h"
#include "pqServerManagerModelItem.h"
#include "vtkCommand.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkSMSessionProxyManager.h"

namespace {
constexpr int kName = 0, kWeight = 1;
constexpr int kRowsSeen = 10;  ///< before the table scrolls
}  // namespace

pqAnamorphNamedWeights::pqAnamorphNamedWeights(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent)
    : pqPropertyWidget(proxy, parent), Table(new QTableWidget(0, 2, this)) {
    this->setShowLabel(false);
    this->Table->setObjectName("Table");
    this->Table->setHorizontalHeaderLabels({tr("Shape"), tr("Weight")});
    this->Table->horizontalHeader()->setStretchLastSection(true);
    this->Table->verticalHeader()->hide();
    this->Table->verticalHeader()->setDefaultSectionSize(this->fontMetrics().height() + 8);
    auto* const clear = new QToolButton(this);
    clear->setObjectName("Clear");
    clear->setText(tr("Clear"));
    clear->setToolTip(tr("No weights of one's own"));
    auto* const layout = new QVBoxLayout(this);
    layout->setContentsMargins(0, 0, 0, 0);
    layout->addWidget(this->Table);
    layout->addWidget(clear);

    QObject::connect(this->Table, &QTableWidget::itemChanged, this, &pqAnamorphNamedWeights::edited);
    QObject::connect(clear, &QToolButton::clicked, this, [this] {
        this->setWeights({});
        Q_EMIT this->weightsChanged();
    });
    for (const char* source : {"Input", "ShapeNames"})
        if (vtkSMProperty* const named = proxy->GetProperty(source))
            this->Watched.emplace_back(
                named, named->AddObserver(vtkCommand::ModifiedEvent, this, &pqAnamorphNamedWeights::refresh));
    QObject::connect(pqApplicationCore::instance()->getServerManagerModel(),
                     &pqServerManagerModel::nameChanged, this, [this] { this->refresh(); });
    this->addPropertyLink(this, "weights", SIGNAL(weightsChanged()), property);
}

pqAnamorphNamedWeights::~pqAnamorphNamedWeights() {
    for (const auto& [named, observer] : this->Watched)
        if (named) named->RemoveObserver(observer);
}

void pqAnamorphNamedWeights::setWeights(const QVariantList& weights) {
    this->Weights = weights;
    this->refresh();
}

void pqAnamorphNamedWeights::showEvent(QShowEvent* event) {
    pqPropertyWidget::showEvent(event);
    this->refresh();
}

QStringList pqAnamorphNamedWeights::names() const {
    QStringList names;
    if (this->proxy()->GetProperty("Input")) {
        const vtkSMPropertyHelper inputs(this->proxy(), "Input");
        for (unsigned int i = 0; i < inputs.GetNumberOfElements(); ++i) {
            vtkSMProxy* const input = inputs.GetAsProxy(i);
            names.append(input ? input->GetSessionProxyManager()->GetProxyName("sources", input) : "");
        }
    } else if (this->proxy()->GetProperty("ShapeNames")) {
        const vtkSMPropertyHelper shapes(this->proxy(), "ShapeNames");
        for (unsigned int i = 0; i < shapes.GetNumberOfElements(); ++i) names.append(shapes.GetAsString(i));
    }
    return names;
}

void pqAnamorphNamedWeights::refresh() {
    const QSignalBlocker silent(this->Table);
    const QStringList names = this->names();
    const int rows = std::max(names.size(), this->Weights.size());
    this->Table->setRowCount(rows);
    for (int row = 0; row < rows; ++row) {
        auto* const name = new QTableWidgetItem(names.value(row));
        name->setFlags(Qt::ItemIsEnabled);
        this->Table->setItem(row, kName, name);
        this->Table->setItem(
            row, kWeight,
            new QTableWidgetItem(row < this->Weights.size() ? number_text(this->Weights[row].toDouble())
                                                            : ""));
    }
    this->Table->resizeColumnToContents(kName);
    const int line = this->Table->verticalHeader()->defaultSectionSize();
    this->Table->setFixedHeight(this->Table->horizontalHeader()->sizeHint().height() +
                                std::clamp(rows, 1, kRowsSeen) * line + 2 * this->Table->frameWidth());
}

void pqAnamorphNamedWeights::edited(QTableWidgetItem* item) {
    bool is_number = false;
    const double weight = item->text().toDouble(&is_number);
    if (item->column() == kWeight && is_number) {
        while (this->Weights.size() < this->Table->rowCount()) this->Weights.append(0.0);
        this->Weights[item->row()] = weight;
        Q_EMIT this->weightsChanged();
    }
    this->refresh();
}
