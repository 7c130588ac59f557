// Layers of the 3D view that can be switched on and off.

import { element } from "../dom";

export interface Layer {
  id: string;
  name: string;
  isOn: boolean;
  show: (isOn: boolean) => void;
}

/** A list of checkboxes; the selection is stored for the next visit. */
export function layerList(layers: readonly Layer[], changed: () => void): HTMLElement {
  const rows = layers.map((layer) => {
    const memory = `eyesim.layer.${layer.id}`;
    layer.isOn = (recall(memory) ?? (layer.isOn ? "1" : "0")) === "1";
    layer.show(layer.isOn);
    const box = element("input", { type: "checkbox", testid: `layer-${layer.id}`, checked: layer.isOn });
    box.onchange = () => {
      layer.isOn = box.checked;
      remember(memory, layer.isOn ? "1" : "0");
      layer.show(layer.isOn);
      changed();
    };
    return element("label", { className: "check" }, [box, layer.name]);
  });
  const fields = element("fieldset", {}, [element("legend", { className: "hidden", textContent: "Layers" }), ...rows]);
  return element("details", { className: "layers", testid: "layers" }, [element("summary", { textContent: "Layers" }), fields]);
}

/** Reads a stored value; a page opened from disk may have no storage. */
function recall(key: string): string | null {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

function remember(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Without storage the value is lost with the page.
  }
}
