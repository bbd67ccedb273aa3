// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphPanoramaStyle
 * @brief looks around from a fixed viewpoint with the mouse (Kim 2003, section 4.5)
 *
 * As in QuickTime VR: dragging with the left button turns the view, so that what is under the mouse in the middle of the
 * window stays there; the wheel, or dragging up and down with the right button, changes the field of view; the arrow keys turn
 * by a tenth of it, and + and - change it. A click of the left button, which turns nothing, invokes PickEvent: hot spots are
 * its observers.
 *
 * The view is Yaw, Pitch and FieldOfView. Each change invokes InteractionEvent, and if MoveCamera is on turns the camera of the
 * renderer under the mouse, or else of the default or first renderer; it stays where it is.
 */
#ifndef vtkAnamorphPanoramaStyle_h
#define vtkAnamorphPanoramaStyle_h

#include "AnamorphRenderingModule.h"  // for the export macro
#include "vtkInteractorStyle.h"

class ANAMORPHRENDERING_EXPORT vtkAnamorphPanoramaStyle : public vtkInteractorStyle {
  public:
    static vtkAnamorphPanoramaStyle* New();
    vtkTypeMacro(vtkAnamorphPanoramaStyle, vtkInteractorStyle);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * The direction of the view, in degrees: yaw to the right of (0, 0, -1), kept from -180 to below 180; and pitch towards
     * (0, 1, 0), kept within PitchRange. A number that is not finite changes nothing. Default: 0, 0.
     */
    void SetYaw(double degrees);
    vtkGetMacro(Yaw, double);
    void SetPitch(double degrees);
    vtkGetMacro(Pitch, double);
    ///@}

    ///@{
    /**
     * The horizontal field of view in degrees, kept within FieldOfViewRange. Default: 90.
     */
    void SetFieldOfView(double degrees);
    vtkGetMacro(FieldOfView, double);
    ///@}

    ///@{
    /**
     * The least and the greatest pitch, within -90 to 90, and field of view, within 0.01 to 179, in degrees. Values out of
     * range, and a greatest value below the least, change nothing. Defaults: -90, 90 and 5, 130.
     */
    void SetPitchRange(double least, double most);
    vtkGetVector2Macro(PitchRange, double);
    void SetFieldOfViewRange(double least, double most);
    vtkGetVector2Macro(FieldOfViewRange, double);
    ///@}

    ///@{
    /**
     * Whether the view turns a camera. Off: the view is for observers of InteractionEvent only. Default: on.
     */
    vtkSetMacro(MoveCamera, bool);
    vtkGetMacro(MoveCamera, bool);
    vtkBooleanMacro(MoveCamera, bool);
    ///@}

    /**
     * Turns the camera to the view, if MoveCamera is on, invokes InteractionEvent, and renders.
     */
    void Look();

    void OnMouseMove() override;
    void OnLeftButtonDown() override;
    void OnLeftButtonUp() override;
    void OnRightButtonDown() override;
    void OnRightButtonUp() override;
    void OnMouseWheelForward() override;
    void OnMouseWheelBackward() override;
    void OnKeyPress() override;
    void OnChar() override;

  protected:
    vtkAnamorphPanoramaStyle() = default;
    ~vtkAnamorphPanoramaStyle() override = default;

  private:
    vtkAnamorphPanoramaStyle(const vtkAnamorphPanoramaStyle&) = delete;
    void operator=(const vtkAnamorphPanoramaStyle&) = delete;

    vtkRenderer* ViewRenderer();
    void Turn(double right, double up);
    void ScaleFieldOfView(double factor);

    int Pressed[2] = {0, 0};
    double Yaw = 0, Pitch = 0, FieldOfView = 90;
    double PitchRange[2] = {-90, 90}, FieldOfViewRange[2] = {5, 130};
    bool MoveCamera = true;
};

#endif
