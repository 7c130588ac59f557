// Creates native elements.

/** An element with properties and children; `testid` and `label` become `data-testid` and `aria-label`. */
export function element<K extends keyof HTMLElementTagNameMap>(
  name: K,
  properties: Partial<HTMLElementTagNameMap[K]> & { testid?: string; label?: string } = {},
  children: readonly (Node | string)[] = [],
): HTMLElementTagNameMap[K] {
  const { testid, label, ...rest } = properties;
  const node = document.createElement(name);
  Object.assign(node, rest);
  if (testid !== undefined) node.dataset["testid"] = testid;
  if (label !== undefined) node.setAttribute("aria-label", label);
  node.append(...children);
  return node;
}
