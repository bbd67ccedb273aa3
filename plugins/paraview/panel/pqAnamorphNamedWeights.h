// SPDX-License-Identifier: Apache-2.0
/**
 * @class   pqAnamorphNamedWeights
 * @brief   Weights in a panel, each beside the name of what it weighs.
 *
 * What is weighed are the inputs of a filter, which have the names of the pipeline, or the shapes of a reader, which says them as ShapeNames.
 * A list that is empty (the filter's or the file's own weights) shows none; once one is typed the others are 0. Clear makes it empty again.
 */
#ifndef pqAnamorphNamedWeights_h
#define pqAnamorphNamedWeights_h

#include <QVariantList>
#include <utility>
#include <vector>

#include "pqPropertyWidget.h"
#include "vtkSMProperty.h"
#include "vtkWeakPointer.h"

class QTableWidget;
class QTableWidgetItem;

class pqAnamorphNamedWeights : public pqPropertyWidget {
    Q_OBJECT
    Q_PROPERTY(QVariantList weights READ weights WRITE setWeights NOTIFY weightsChanged)

  public:
    pqAnamorphNamedWeights(vtkSMProxy* proxy, vtkSMProperty* property, QWidget* parent = nullptr);
    ~pqAnamorphNamedWeights() override;

    QVariantList weights() const { return this->Weights; }
    void setWeights(const QVariantList& weights);

  Q_SIGNALS:
    void weightsChanged();

  protected:
    void showEvent(QShowEvent* event) override;

  private:
    QStringList names() const;
    void refresh();
    void edited(QTableWidgetItem* item);

    QVariantList Weights;
    QTableWidget* Table;
    std::vector<std::pair<vtkWeakPointer<vtkSMProperty>, unsigned long>> Watched;  ///< by these observers
};

#endif
