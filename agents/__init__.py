"""Which agents come with the repository? Players, training and evaluation; not part of the installed
package."""
