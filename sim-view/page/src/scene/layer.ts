// Which layers of the 3D view are shown.

import { element } from "../dom";

export interface Layer {
  id: string;
  name: string;
  isOn: boolean;
  show: (isOn: boolean) => void;
}

/** A list of checkboxes; what was chosen is remembered. */
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

/** A page from disk may have no storage. */
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
    // It is forgotten with the page.
  }
}
